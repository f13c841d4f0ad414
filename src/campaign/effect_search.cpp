#include "campaign/effect_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "numerics/chi_squared.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

constexpr double redundant_below = 1e-3;  // share of the variance after the base, given other groups
/// Minimum share of a column's variance that the base does not explain; single precision has errors of 1e-6.
constexpr double min_remaining = 1e-6;
/// Minimum length of the column of a shape, whitened. Shorter columns explain no residual: their coefficients
/// have a prior of variance 1. The rounding errors of a zero column would make the equations singular.
constexpr double min_shape = 1e-3;
constexpr double errors_beyond_bounds = 2.0;
constexpr double enough_blocks = 12.0;
constexpr double few_blocks_penalty = 6.0;
/// Size of an effect, relative to a stronger one, that errors of the linear search may imitate; 0.5 to 1.4 %
/// were seen with a drift of 0.4 hPa/h and a gain of 1 %.
constexpr double linear_to = 0.02;

// The mixture adds components with sizes larger and much smaller by `spread_of_sizes`; the small one
// describes the remainder of an effect that a law includes imperfectly.
struct Tail {
  double times;
  double share;
};
constexpr std::array<Tail, 4> tails{{{1.0, 0.65}, {0.1, 0.1}, {3.0, 0.2}, {widest_prior, 0.05}}};

/// Columns of a group that the base and its other columns do not imitate, ascending.
/// @param products of its columns, of unit length, after the base
std::vector<Eigen::Index> identifiable_of(Eigen::MatrixXd products) {
  std::vector<Eigen::Index> identifiable;
  while (identifiable.size() < static_cast<std::size_t>(products.cols())) {
    Eigen::Index next = 0;
    const double pivot = products.diagonal().maxCoeff(&next);
    if (!(pivot > min_remaining)) break;
    identifiable.push_back(next);
    products -= Eigen::MatrixXd(products.col(next) * products.row(next) / pivot);
    for (const Eigen::Index column : identifiable) products(column, column) = 0.0;
  }
  std::sort(identifiable.begin(), identifiable.end());
  return identifiable;
}

bool is_in(std::size_t value, const std::vector<std::size_t>& set) {
  return std::find(set.begin(), set.end(), value) != set.end();
}

}  // namespace

std::vector<std::size_t> set_without(std::vector<std::size_t> set, std::size_t group) {
  set.erase(std::remove(set.begin(), set.end(), group), set.end());
  return set;
}

std::vector<Eigen::Index> indices_of(const ColumnGroup& group, Eigen::Index base) {
  std::vector<Eigen::Index> indices(static_cast<std::size_t>(group.count));
  std::iota(indices.begin(), indices.end(), base + group.first);
  return indices;
}

std::vector<Eigen::Index> indices_of(const std::vector<std::size_t>& some,
                                     const std::vector<ColumnGroup>& groups, Eigen::Index base) {
  std::vector<Eigen::Index> indices(static_cast<std::size_t>(base));
  std::iota(indices.begin(), indices.end(), Eigen::Index{0});
  for (const std::size_t group : some) {
    const std::vector<Eigen::Index> of_group = indices_of(groups[group], base);
    indices.insert(indices.end(), of_group.begin(), of_group.end());
  }
  return indices;
}

double distinct_squares(const Eigen::MatrixXd& information, const std::vector<Eigen::Index>& rest,
                        const std::vector<Eigen::Index>& columns, const Eigen::VectorXd& coefficients) {
  const Eigen::VectorXd across = information(rest, columns) * coefficients;
  const double imitated = across.dot(pseudo_solution(information(rest, rest), across));
  return std::max(0.0, coefficients.dot(information(columns, columns) * coefficients) - imitated);
}

EffectSearch::EffectSearch(const WhitenedSystem& scores, Eigen::Index base,
                           const std::vector<ColumnGroup>& groups)
    : scores_(&scores), base_(base), groups_(groups) {
  const Eigen::Index columns = scores.columns();
  const Eigen::Index tested = columns - base;
  const auto inverse_lengths = [&](const Eigen::MatrixXd& products) {
    Eigen::VectorXd scale = products.diagonal().head(columns);
    for (double& value : scale) value = value > 0.0 ? 1.0 / std::sqrt(value) : 0.0;
    return scale;
  };
  scale_ = inverse_lengths(scores.information);
  const Eigen::MatrixXd after = products_after(scores.information, base);
  const Eigen::VectorXd scale = scale_.tail(tested);
  scaled_information_ = scale.asDiagonal() * after.topLeftCorner(tested, tested) * scale.asDiagonal();
  scaled_score_ = scale.cwiseProduct(after.col(tested).head(tested));
  squares_ = after(tested, tested);

  // Imitation by the base does not depend on drift: likely drift hides slow columns but does not remove them.
  const Eigen::VectorXd length = inverse_lengths(scores.plain).tail(tested);
  const Eigen::MatrixXd plain_after = length.asDiagonal() *
                                      products_after(scores.plain, base).topLeftCorner(tested, tested) *
                                      length.asDiagonal();

  Eigen::Index width = 0;
  for (const ColumnGroup& group : groups) {
    const Eigen::MatrixXd information =
        scaled_information_.block(group.first, group.first, group.count, group.count);
    const Eigen::MatrixXd plain = plain_after.block(group.first, group.first, group.count, group.count);
    remaining_.push_back(group.count == 0 ? 0.0 : std::clamp(plain.diagonal().maxCoeff(), 0.0, 1.0));
    const std::vector<Eigen::Index>& identifiable = identifiable_.emplace_back(identifiable_of(plain));
    const Eigen::Index kept = as_index(identifiable.size());
    Eigen::MatrixXd turned = Eigen::MatrixXd::Zero(group.count, kept);
    if (kept > 0) {
      const SymmetricEigen solver(information(identifiable, identifiable));
      // The symmetric root, unlike eigenvectors, is not moved by rounding errors.
      turned(identifiable, Eigen::all) =
          solver.eigenvectors() *
          solver.eigenvalues().cwiseMax(rank_limit).cwiseSqrt().cwiseInverse().asDiagonal() *
          solver.eigenvectors().transpose();
    }
    turned_.push_back(std::move(turned));
    begin_.push_back(width);
    width += kept;
    candidates_ += group.count;
  }
  const Eigen::Index shapes = tested - candidates_;
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(tested, width + shapes);
  turn.bottomRightCorner(shapes, shapes).setIdentity();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    turn.block(groups[g].first, begin_[g], groups[g].count, turned_[g].cols()) = turned_[g];
  }
  information_ = turn.transpose() * scaled_information_ * turn;
  score_ = turn.transpose() * scaled_score_;
}

double EffectSearch::remaining(std::size_t group, const Eigen::VectorXd& coefficients) const {
  const std::vector<Eigen::Index> indices = indices_of(groups_[group], base_);
  const double whole = coefficients.dot(scores_->plain(indices, indices) * coefficients);
  if (!(whole > 0.0)) return 0.0;
  return std::min(
      1.0, distinct_squares(scores_->plain, indices_of({}, groups_, base_), indices, coefficients) / whole);
}

std::vector<Eigen::Index> EffectSearch::shapes_of(const std::vector<std::size_t>& set) const {
  std::vector<Eigen::Index> shapes;
  for (const std::size_t group : set) {
    for (Eigen::Index k = 0; k < groups_[group].shape_count; ++k) {
      const Eigen::Index shape = groups_[group].shape_first + k;
      if (scale_[base_ + shape] * min_shape < 1.0) shapes.push_back(shape);
    }
  }
  return shapes;
}

EffectSearch::Conditional EffectSearch::given(const std::vector<std::size_t>& groups) const {
  Conditional result{information_, score_, squares_, 1.0};
  std::vector<Eigen::Index> indices;  // turned columns of the groups
  for (const std::size_t group : groups) {
    for (Eigen::Index k = 0; k < turned_[group].cols(); ++k) indices.push_back(begin_[group] + k);
  }
  const std::size_t count = indices.size();
  const std::vector<Eigen::Index> shapes = shapes_of(groups);
  const Eigen::Index turned = information_.cols() - (scaled_information_.cols() - candidates_);
  for (const Eigen::Index shape : shapes) indices.push_back(turned + shape - candidates_);
  if (!indices.empty()) {
    Eigen::MatrixXd information = information_(indices, indices);
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      const double scale = scale_[base_ + shapes[k]];
      information(as_index(count + k), as_index(count + k)) += scale * scale;
    }
    const Eigen::MatrixXd inverse = pseudo_inverse(information, redundant_below);
    const Eigen::MatrixXd across = information_(Eigen::all, indices);
    const Eigen::MatrixXd solution = inverse * across.transpose();
    const Eigen::VectorXd score = score_(indices);
    result.information -= across * solution;
    result.score -= solution.transpose() * score;
    result.squares -= score.dot(inverse * score);
  }
  const double degrees_of_freedom =
      static_cast<double>(scores_->row_count) - static_cast<double>(base_) - static_cast<double>(count);
  result.variance = std::max(result.squares, 0.0) / std::max(degrees_of_freedom, 1.0);
  return result;
}

GroupScore EffectSearch::score_in(const Conditional& conditional, std::size_t group) const {
  GroupScore result;
  const ColumnGroup& columns = groups_[group];
  const Eigen::Index count = turned_[group].cols();
  const Eigen::Index begin = begin_[group];
  result.estimate = Eigen::VectorXd::Zero(columns.count);
  result.covariance = Eigen::MatrixXd::Zero(columns.count, columns.count);
  if (count == 0 || !(conditional.variance > 0.0)) return result;
  const Eigen::MatrixXd information = conditional.information.block(begin, begin, count, count);
  for (const double value : symmetric_eigenvalues(information))
    result.degrees_of_freedom += value > redundant_below ? 1.0 : 0.0;
  if (result.degrees_of_freedom == 0.0) return result;
  const Eigen::MatrixXd inverse = pseudo_inverse(information, redundant_below);
  const Eigen::VectorXd score = conditional.score.segment(begin, count);
  result.chi2 = score.dot(inverse * score) / conditional.variance;
  result.chi2_one_dof = chi2_one_dof(result.chi2, result.degrees_of_freedom);
  const Eigen::VectorXd scale = scale_.segment(base_ + columns.first, columns.count);
  const Eigen::MatrixXd turn = scale.asDiagonal() * turned_[group];
  result.estimate = turn * (inverse * score);
  result.covariance = conditional.variance * (turn * inverse * turn.transpose());
  result.possible = true;
  for (Eigen::Index k = 0; k < columns.count; ++k) {
    const Bounds& bounds = columns.bounds[static_cast<std::size_t>(k)];
    const double slack = errors_beyond_bounds * std::sqrt(result.covariance(k, k));
    if (result.estimate[k] + slack < bounds.lower || result.estimate[k] - slack > bounds.upper)
      result.possible = false;
    const auto number = static_cast<std::size_t>(k);
    if (number < columns.typical.size() && columns.typical[number] != 0.0 &&
        std::abs(result.estimate[k]) - slack > columns.max_relative_size * std::abs(columns.typical[number]))
      result.possible = false;
  }
  return result;
}

GroupScore EffectSearch::score(std::size_t group, const std::vector<std::size_t>& others) const {
  return score_in(given(set_without(others, group)), group);
}

Eigen::MatrixXd EffectSearch::normal_turn(const Conditional& conditional,
                                          const std::vector<std::size_t>& groups,
                                          std::vector<Directions>& directions) const {
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(information_.cols(), information_.cols());
  Eigen::Index width = 0;
  directions.clear();
  for (const std::size_t group : groups) {
    const Eigen::Index begin = begin_[group];
    const Eigen::Index count = turned_[group].cols();
    const SymmetricEigen solver(conditional.information.block(begin, begin, count, count));
    const auto kept = solver.eigenvalues().array() > redundant_below;
    const Eigen::VectorXd root = kept.select(solver.eigenvalues().cwiseSqrt().cwiseInverse(), 0.0);
    turn.block(begin, width, count, count) =
        solver.eigenvectors() * root.asDiagonal() * solver.eigenvectors().transpose();
    width += count;
    directions.push_back({count, kept.count()});
  }
  return turn.leftCols(width);
}

double EffectSearch::threshold_of(const Conditional& conditional, const std::vector<std::size_t>& groups,
                                  const SearchOptions& options) const {
  std::vector<Directions> directions;
  const Eigen::MatrixXd turn = normal_turn(conditional, groups, directions);
  if (turn.cols() == 0) return std::numeric_limits<double>::infinity();
  return quantile_of_maximum(turn.transpose() * conditional.information * turn, directions,
                             options.confidence, options.draws, options.seed);
}

std::vector<Eigen::VectorXd> EffectSearch::rows_after(std::size_t group,
                                                      const std::vector<std::size_t>& others) const {
  const Eigen::Index columns = scores_->columns();
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(columns);  // weights of the unscaled columns
  const ColumnGroup& group_columns = groups_[group];
  GroupScore found = score(group, others);
  if (found.estimate.isZero()) {
    const Eigen::Index kept = turned_[group].cols();
    if (kept > 0)
      found.estimate = scale_.segment(base_ + group_columns.first, group_columns.count).asDiagonal() *
                       turned_[group].col(kept - 1);
  }
  weight.segment(base_ + group_columns.first, group_columns.count) = found.estimate;
  const std::vector<Eigen::Index> rest = indices_of(set_without(others, group), groups_, base_);
  const Eigen::VectorXd imitated = scores_->information(rest, Eigen::all).leftCols(columns) * weight;
  weight(rest) = -pseudo_solution(scores_->information(rest, rest), imitated);
  return scores_->sums_of_columns(weight);
}

double EffectSearch::level(std::size_t winner, const std::vector<std::size_t>& chosen,
                           double threshold) const {
  const std::vector<Eigen::VectorXd> rows = rows_after(winner, chosen);
  const Eigen::VectorXd information =
      scores_->by_minutes([&rows](std::size_t f) { return rows[f].cwiseAbs2(); });
  const double squares = information.squaredNorm();
  const double blocks = squares > 0.0 ? information.sum() * information.sum() / squares : 0.0;
  if (blocks < enough_blocks) return threshold * (1.0 + few_blocks_penalty / std::max(blocks, 1.0));
  // Noise in the score of the group by minutes: the remainder after its effect is subtracted.
  const std::vector<std::size_t> with = set_with(chosen, winner);
  const std::vector<Eigen::VectorXd> residuals = residuals_after(with);
  const Eigen::VectorXd sums =
      scores_->by_minutes([&](std::size_t f) { return rows[f].cwiseProduct(residuals[f]); });
  const auto whole =
      scores_->partition.all_reduce_flights<double>([&rows](std::size_t f) { return rows[f].squaredNorm(); });
  const Eigen::VectorXd noise = sums / std::sqrt(whole);
  // Ratio of its observed variation between minutes to the noise model.
  return threshold * std::max(1.0, noise.squaredNorm() / variance(with));
}

std::vector<Eigen::VectorXd> EffectSearch::residuals_after(const std::vector<std::size_t>& chosen) const {
  Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(scores_->columns());
  coefficients(indices_of(chosen, groups_, base_)) = fit(chosen).estimate;
  return scores_->residuals_after(coefficients);
}

bool EffectSearch::is_taken(std::size_t group, const std::vector<std::size_t>& chosen) const {
  return std::any_of(chosen.begin(), chosen.end(), [&](std::size_t each) {
    return each != group && groups_[each].effect == groups_[group].effect;
  });
}

bool EffectSearch::all_possible(const std::vector<std::size_t>& chosen) const {
  return std::all_of(chosen.begin(), chosen.end(), [&](std::size_t group) {
    return !is_taken(group, chosen) && score(group, chosen).possible;
  });
}

Eigen::VectorXd EffectSearch::precision_of(std::size_t group, double times) const {
  const ColumnGroup& columns = groups_[group];
  // Unknown sizes are limited by the rest of the residual.
  Eigen::VectorXd precision =
      Eigen::VectorXd::Constant(columns.count, 1.0 / static_cast<double>(scores_->row_count));
  for (std::size_t k = 0; k < columns.typical.size(); ++k) {
    if (columns.deviation(k) == 0.0) continue;
    const double scaled = scale_[base_ + columns.first + as_index(k)] / (columns.deviation(k) * times);
    precision[as_index(k)] = scaled * scaled;
  }
  return precision;
}

double EffectSearch::log_ratio(const std::vector<Eigen::Index>& columns,
                               const Eigen::VectorXd& precision) const {
  const Eigen::VectorXd deviation = precision.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inner =
      deviation.asDiagonal() * scaled_information_(columns, columns) * deviation.asDiagonal();
  const Cholesky factor(Eigen::MatrixXd::Identity(inner.rows(), inner.cols()) + inner);
  const Eigen::VectorXd right = deviation.cwiseProduct(scaled_score_(columns));
  const double explained = right.dot(factor.solve(right));
  const double degrees_of_freedom = static_cast<double>(scores_->row_count) - static_cast<double>(base_);
  return -0.5 * degrees_of_freedom * std::log1p(-std::min(explained / squares_, 1.0 - 1e-12)) -
         0.5 * factor.log_determinant();
}

double EffectSearch::evidence(const std::vector<std::size_t>& set,
                              const std::vector<std::size_t>& uncertain) const {
  std::vector<Eigen::Index> columns;
  std::vector<Eigen::Index> begin;
  for (const std::size_t group : set) {
    begin.push_back(as_index(columns.size()));
    for (const Eigen::Index column : identifiable_[group]) columns.push_back(groups_[group].first + column);
  }
  if (columns.empty()) return 0.0;
  const std::vector<Eigen::Index> shapes = shapes_of(uncertain);
  columns.insert(columns.end(), shapes.begin(), shapes.end());
  // The precision of the shapes; `choose` sets the precision of the effects.
  Eigen::VectorXd precision = scale_.tail(scaled_information_.cols())(columns).cwiseAbs2().cwiseMax(1e-300);
  const auto choose = [&](std::size_t i, const Tail& tail) {
    precision.segment(begin[i], as_index(identifiable_[set[i]].size())) =
        precision_of(set[i], tail.times)(identifiable_[set[i]]);
  };
  std::vector<double> share(set.size(), std::log(tails.front().share));
  for (std::size_t i = 0; i < set.size(); ++i) choose(i, tails.front());
  double best = log_ratio(columns, precision);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const Tail* chosen = &tails.front();
    for (const Tail& tail : tails) {
      choose(i, tail);
      const double value = log_ratio(columns, precision);
      if (value + std::log(tail.share) <= best + share[i]) continue;
      best = value;
      share[i] = std::log(tail.share);
      chosen = &tail;
    }
    choose(i, *chosen);
  }
  return best + std::accumulate(share.begin(), share.end(), 0.0);
}

void EffectSearch::improve(std::vector<std::size_t>& chosen, double price) const {
  const auto merit = [&](const std::vector<std::size_t>& set) {
    return evidence(set) - price * static_cast<double>(set.size());
  };
  double best = merit(chosen);
  for (bool moved = true; moved;) {
    moved = false;
    const std::vector<std::size_t> now = chosen;
    const auto consider = [&](const std::vector<std::size_t>& set) {
      const double value = merit(set);
      if (!(value > best) || !all_possible(set)) return;
      best = value;
      chosen = set;
      moved = true;
    };
    for (const std::size_t out : now) {
      const std::vector<std::size_t> rest = set_without(now, out);
      consider(rest);
      for (std::size_t in = 0; in < groups_.size(); ++in) {
        if (is_absorbed(in) || is_in(in, now)) continue;
        const std::vector<std::size_t> set = set_with(rest, in);
        consider(set);
        for (const std::size_t other : rest) {
          if (other < out) consider(set_without(set, other));
        }
      }
    }
  }
}

void EffectSearch::prefer_usual_shapes(std::vector<std::size_t>& chosen) const {
  constexpr double significant = 4.5;  // change of the log likelihood, chi2 of 9
  for (std::size_t& group : chosen) {
    const auto first_shape = std::find_if(groups_.begin(), groups_.end(), [&](const ColumnGroup& each) {
      return each.effect == groups_[group].effect && each.system == groups_[group].system;
    });
    const auto first = static_cast<std::size_t>(first_shape - groups_.begin());
    if (first == group || is_absorbed(first)) continue;
    const double as_it_is = evidence(chosen);
    const std::size_t shape = std::exchange(group, first);
    if (evidence(chosen) < as_it_is - significant || !all_possible(chosen)) group = shape;
  }
}

std::vector<std::size_t>::iterator EffectSearch::first_error_of_linearity(
    const std::vector<std::size_t>& references, std::vector<std::size_t>& chosen) const {
  const Eigen::Index count =
      references.empty() ? 1 : as_index(*std::max_element(references.begin(), references.end())) + 1;
  std::vector<Eigen::VectorXd> squares;  // sums of each effect against each reference
  for (const std::size_t group : chosen) {
    const std::vector<Eigen::VectorXd> rows = rows_after(group, chosen);
    squares.push_back(scores_->partition.all_reduce_flights<Eigen::VectorXd>([&](std::size_t f) {
      Eigen::VectorXd of_flight = Eigen::VectorXd::Zero(count);
      of_flight[references.empty() ? 0 : as_index(references[f])] = rows[f].squaredNorm();
      return of_flight;
    }));
  }
  const auto weak = std::find_if(squares.begin(), squares.end(), [&squares](const Eigen::VectorXd& each) {
    return std::any_of(squares.begin(), squares.end(), [&each](const Eigen::VectorXd& strong) {
      return linear_to * linear_to * strong.dot(each) > each.sum() * each.sum();
    });
  });
  return chosen.begin() + (weak - squares.begin());
}

SearchResult EffectSearch::run(const SearchOptions& options) const {
  SearchResult result;
  std::vector<std::size_t> open;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (!is_absorbed(g)) open.push_back(g);
  }
  std::vector<std::size_t>& chosen = result.chosen;
  // Penalty for the number of effects: each effect of a set needs evidence.
  const double price = std::log(static_cast<double>(open.size()));
  std::vector<std::vector<std::size_t>> seen;
  while (true) {
    const Conditional conditional = given(chosen);
    std::vector<std::size_t> rest;
    std::size_t winner = groups_.size();
    double best_value = 0.0;
    GroupScore best;
    for (const std::size_t group : open) {
      if (is_in(group, chosen) || is_taken(group, chosen)) continue;
      rest.push_back(group);
      const GroupScore score = score_in(conditional, group);
      if (!score.possible) continue;
      const double value = evidence(set_with(chosen, group));
      if (winner != groups_.size() && value <= best_value) continue;
      best_value = value;
      best = score;
      winner = group;
    }
    const double threshold =
        options.threshold ? *options.threshold : threshold_of(conditional, rest, options);
    if (chosen.empty()) result.threshold = threshold;
    if (winner == groups_.size() || chosen.size() >= options.max_effects || !(best.chi2_one_dof > threshold))
      break;
    if (!options.threshold && !(best.chi2_one_dof > level(winner, chosen, threshold))) break;
    chosen.push_back(winner);
    improve(chosen, price);
    if (std::find(seen.begin(), seen.end(), chosen) != seen.end()) break;
    seen.push_back(chosen);
  }
  if (!options.threshold) prefer_usual_shapes(chosen);
  const auto first_weak = [&] {
    return std::find_if(chosen.begin(), chosen.end(), [&](std::size_t group) {
      const GroupScore now = score(group, chosen);
      return !now.possible || !(now.chi2_one_dof > result.threshold);
    });
  };
  // One at a time: without it, similar effects explain more.
  while (true) {
    auto weak = first_weak();
    if (weak == chosen.end()) weak = first_error_of_linearity(options.references, chosen);
    if (weak == chosen.end()) break;
    chosen.erase(weak);
  }
  const std::vector<std::size_t> set = chosen;
  std::sort(chosen.begin(), chosen.end(),
            [&](std::size_t a, std::size_t b) { return score(a, set).chi2 > score(b, set).chi2; });
  for (const std::size_t group : chosen) {
    // Number of independent groups whose best score has this threshold.
    const double effective = (1.0 - options.confidence) / chi_squared_tail(result.threshold, 1.0);
    result.p_values.push_back(
        std::min(1.0, effective * chi_squared_tail(score(group, chosen).chi2_one_dof, 1.0)));
  }
  return result;
}

double EffectSearch::correlation(std::size_t a, std::size_t b, const std::vector<std::size_t>& others) const {
  const Conditional conditional = given(set_without(set_without(others, a), b));
  std::vector<Directions> directions;
  const Eigen::MatrixXd turn = normal_turn(conditional, {a, b}, directions);
  if (directions[0].degrees_of_freedom == 0 || directions[1].degrees_of_freedom == 0) return 0.0;
  const Eigen::MatrixXd turned = turn.transpose() * conditional.information * turn;
  const Eigen::MatrixXd across = turned.topRightCorner(directions[0].count, directions[1].count);
  if (across.size() == 1) return std::clamp(across(0, 0), -1.0, 1.0);
  return std::clamp(singular_values(across)[0], 0.0, 1.0);
}

SearchFit EffectSearch::fit(const std::vector<std::size_t>& chosen) const {
  std::vector<Eigen::Index> indices = indices_of({}, groups_, base_);  // positions among the scores' columns
  std::vector<Eigen::Index> out = indices;                             // positions among the estimates
  Eigen::VectorXd prior = Eigen::VectorXd::Zero(scores_->columns());   // precision of each of these
  Eigen::Index size = base_;
  for (const std::size_t group : chosen) {
    const Eigen::VectorXd precision = precision_of(group, tails.back().times);
    for (const Eigen::Index column : identifiable_[group]) {
      if (groups_[group].deviation(static_cast<std::size_t>(column)) != 0.0)
        prior[as_index(indices.size())] = precision[column];
      indices.push_back(base_ + groups_[group].first + column);
      out.push_back(size + column);
    }
    size += groups_[group].count;
  }
  const Eigen::VectorXd scale = scale_(indices);
  Eigen::MatrixXd scaled = scale.asDiagonal() * scores_->information(indices, indices) * scale.asDiagonal();
  scaled.diagonal() += prior.head(scaled.cols());
  const Eigen::MatrixXd inverse =
      scale.asDiagonal() * pseudo_inverse(scaled, rank_limit) * scale.asDiagonal();
  SearchFit result{Eigen::VectorXd::Zero(size), Eigen::MatrixXd::Zero(size, size)};
  result.estimate(out) = inverse * scores_->information.col(scores_->columns())(indices);
  result.covariance(out, out) = variance(chosen) * inverse;
  return result;
}

}  // namespace pcor::internal
