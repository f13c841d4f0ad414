#include "diagnose/structure.hpp"

#include <boost/random/uniform_real_distribution.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <pcor/numerics/noise.hpp>

#include "campaign/whitened.hpp"
#include "numerics/chi_squared.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/median.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t max_columns = 6;
constexpr std::size_t fine_columns = 24;
constexpr std::size_t bins_per_column = 40;
constexpr double max_missing = 0.1;
constexpr double min_remaining_direction = 1e-3;  // part of a direction remaining after the model
constexpr Eigen::Index draws = 99;  // draws for each of the two ways of removing the dependence on variables
/// Fractions of the drift rms that may remain after a variable explains part of it.
constexpr std::array<double, 3> parts_of_drift{1.0, 0.4, 0.0};

/// @param shift_seed seed of the shifts; @param sign_seed seed of the signs, combined with the minute
DrawnResiduals drawn(const Eigen::VectorXd& residual, const Binning& bins, std::uint64_t shift_seed,
                     std::uint64_t sign_seed) {
  constexpr double length = 60.0;  // s
  DrawnResiduals result{Eigen::MatrixXd(residual.size(), draws), residual};
  std::mt19937_64 shifts(shift_seed);
  boost::random::uniform_real_distribution<double> part(0.1, 0.9);  // the same on every machine
  for (Eigen::Index k = 0; k < draws; ++k) {
    const auto first = static_cast<Eigen::Index>(part(shifts) * static_cast<double>(residual.size()));
    std::rotate_copy(residual.begin(), residual.begin() + first, residual.end(),
                     result.shifted.col(k).begin());
  }
  std::vector<double> minutes;
  for (const double time : bins.time()) {
    const double minute = std::floor(time / length);
    if (minutes.empty() || minute != minutes.back()) minutes.push_back(minute);
    result.minute.push_back(as_index(minutes.size()) - 1);
  }
  result.signs.resize(as_index(minutes.size()), draws);
  for (std::size_t m = 0; m < minutes.size(); ++m) {
    std::mt19937_64 engine(sign_seed + static_cast<std::uint64_t>(minutes[m]));
    for (Eigen::Index k = 0; k < draws; ++k) result.signs(as_index(m), k) = (engine() & 1U) != 0 ? 1.0 : -1.0;
  }
  return result;
}

/// Probability that a value is reached by chance, from random draws.
double p_value_among(double value, const Eigen::VectorXd& others) {
  constexpr double euler = 0.57721566490153286;
  const auto count = static_cast<double>(others.size());
  const double mean = others.mean();
  const double deviation = std::sqrt((others.array() - mean).square().sum() / (count - 1.0));
  const double width = deviation * std::sqrt(6.0) / std::acos(-1.0);
  if (!(width > 0.0)) return 1.0;
  // Beyond all draws the extreme-value law determines the probability, limited by the number of draws.
  const double by_law = -std::expm1(-std::exp(-(value - mean) / width - euler));
  const double by_number = static_cast<double>((others.array() >= value).count()) / count;
  return std::max(by_law, by_number);
}

/// Whitened residuals of each local flight after least squares of all columns.
std::vector<Eigen::VectorXd> least_squares_residuals(const WhitenedSystem& scores) {
  const Eigen::Index width = scores.columns();
  return scores.residuals_after(pseudo_solution(scores.information.topLeftCorner(width, width),
                                                scores.information.col(width).head(width)));
}

}  // namespace

Eigen::MatrixXd DrawnResiduals::products_with(const Eigen::MatrixXd& columns) const {
  Eigen::MatrixXd by_minutes = Eigen::MatrixXd::Zero(signs.rows(), columns.cols());
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    for (std::size_t i = 0; i < minute.size(); ++i)
      by_minutes(minute[i], c) += residual[as_index(i)] * columns(as_index(i), c);
  }
  return side_by_side(columns.transpose() * shifted, by_minutes.transpose() * signs);
}

StructureTest::StructureTest(const FlightPartition& partition, const BinnedFlights& binned,
                             const NoiseModel& noise, std::uint64_t seed,
                             const std::vector<Eigen::MatrixXd>& aside)
    : partition_(partition), bins_(binned.bins), largest_(Eigen::VectorXd::Zero(2 * draws)) {
  alone_ = std::numeric_limits<double>::infinity();
  const std::vector<Eigen::VectorXd>& residuals = binned.residuals;
  std::vector<Eigen::MatrixXd> with_aside = binned.columns;
  for (std::size_t f = 0; f < aside.size(); ++f) with_aside[f] = side_by_side(binned.columns[f], aside[f]);
  for (const double part : parts_of_drift) {
    if (part < 1.0 && !noise.has_drift()) break;
    Whitened& flights = whitened_.emplace_back();
    NoiseModel remaining_noise = noise;
    for (double& slow : remaining_noise.drift_component_rms) slow *= part;
    const WhitenedSystem scores = whiten_system(partition, bins_, binned.columns, residuals, remaining_noise);
    rows_ = scores.row_count;
    const Eigen::Index width = scores.columns();
    flights.inverse = information_inverse(scores.information.topLeftCorner(width, width));
    flights.squares = products_after(scores.information, width)(0, 0);
    flights.residuals = least_squares_residuals(scores);
    for (std::size_t f = 0; f < bins_.size(); ++f) {
      flights.whitening.emplace_back(bins_[f], remaining_noise, f);
      flights.model.emplace_back();
      if (partition.is_local(f)) flights.model[f] = scores.rows[f].leftCols(width);
    }
    flights.determinant = partition.all_reduce_flights<double>(
        [&flights](std::size_t f) { return flights.whitening[f].log_determinant(); });
    const std::vector<Eigen::VectorXd> noise_alone =
        aside.empty() ? flights.residuals
                      : least_squares_residuals(
                            whiten_system(partition, bins_, with_aside, residuals, remaining_noise));
    flights.drawn.resize(bins_.size());
    flights.model_with_drawn = partition.all_reduce_flights<Eigen::MatrixXd>(
        [&](std::size_t f) {
          flights.drawn[f] = drawn(noise_alone[f], bins_[f], seed + f, seed);
          return flights.drawn[f].products_with(flights.model[f]);
        },
        partition.threads());
    alone_ = std::min(alone_, minus_likelihood(flights, 0.0));
  }
}

double StructureTest::minus_likelihood(const Whitened& flights, double explained) const {
  const double remaining_squares = std::max(flights.squares - explained, 1e-9 * flights.squares);
  return flights.determinant + static_cast<double>(rows_) * std::log(remaining_squares);
}

bool StructureTest::add(const TestedVariable& variable) {
  const VariableValues known(partition_, [&](std::size_t f) {
    std::vector<double> of_flight;
    for (const std::size_t record : bins_[f].records()) of_flight.push_back((*variable.values[f])[record]);
    return of_flight;
  });
  const auto missing = static_cast<double>(known.missing);
  if (missing > max_missing * (missing + static_cast<double>(known.values.size()))) return false;
  const std::size_t before = structures_.size();
  const std::size_t maximum = rows_ / bins_per_column;
  add(variable, variable.turn > 0.0
                    ? Smooth::periodic(known, variable.turn)
                    : Smooth::with_knots_at_values(known, std::clamp(maximum, std::size_t{1}, max_columns)));
  if (variable.fine && maximum > max_columns)
    add(variable, Smooth::with_even_knots(known, std::min(maximum, fine_columns)));
  return structures_.size() > before;
}

std::vector<Eigen::MatrixXd> StructureTest::columns_of(const Smooth& smooth,
                                                       const TestedVariable& variable) const {
  const Eigen::Index count = as_index(smooth.columns());
  std::vector<double> functions(smooth.columns());
  std::vector<Eigen::MatrixXd> columns;
  for (std::size_t f = 0; f < bins_.size(); ++f) {
    const Binning& bins = bins_[f];
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(as_index(bins.size()), count);
    Eigen::VectorXd counts = Eigen::VectorXd::Zero(as_index(bins.size()));
    double last = smooth.centre();
    for (std::size_t k = 0; k < bins.records().size(); ++k) {
      const double value = (*variable.values[f])[bins.records()[k]];
      if (std::isfinite(value)) last = value;
      smooth.evaluate(last, functions.data());
      sums.row(bins.bins()[k]) += Eigen::Map<const Eigen::RowVectorXd>(functions.data(), count);
      counts[bins.bins()[k]] += 1.0;
    }
    columns.emplace_back(counts.cwiseInverse().asDiagonal() * sums);
  }
  return columns;
}

Eigen::MatrixXd StructureTest::products(std::size_t flight, const Eigen::MatrixXd& columns) const {
  const Eigen::Index count = columns.cols();
  const Eigen::Index model = whitened_.front().inverse.rows();
  const Eigen::Index width = count + model + 1 + 2 * draws;
  Eigen::MatrixXd all(count, width * as_index(whitened_.size()));
  for (std::size_t k = 0; k < whitened_.size(); ++k) {
    const Whitened& flights = whitened_[k];
    const Eigen::MatrixXd white = flights.whitening[flight](columns);
    auto part = all.middleCols(width * as_index(k), width);
    part.leftCols(count) = white.transpose() * white;
    part.middleCols(count, model) = white.transpose() * flights.model[flight];
    part.col(count + model) = white.transpose() * flights.residuals[flight];
    part.rightCols(2 * draws) = flights.drawn[flight].products_with(white);
  }
  return all;
}

StructureTest::ExplainedSquares StructureTest::explained_by(const Eigen::MatrixXd& products,
                                                            const Whitened& flights) {
  const Eigen::Index count = products.rows();
  const Eigen::Index model = flights.inverse.rows();
  Eigen::MatrixXd information = products.leftCols(count);
  const Eigen::MatrixXd with_model = products.middleCols(count, model).transpose();
  const Eigen::VectorXd score = products.col(count + model);
  Eigen::MatrixXd drawn = products.rightCols(2 * draws);
  const Eigen::MatrixXd solution = flights.inverse * with_model;
  const Eigen::VectorXd before = information.diagonal();
  information -= with_model.transpose() * solution;
  drawn -= solution.transpose() * flights.model_with_drawn;

  ExplainedSquares explained;
  if (information(0, 0) > min_remaining_direction * before[0]) {
    explained.line_score = score[0];
    explained.line_information = information(0, 0);
    explained.line = score[0] * score[0] / information(0, 0);
  }
  const Eigen::VectorXd scale = before.cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const SymmetricEigen solver(scale.asDiagonal() * information * scale.asDiagonal());
  Eigen::MatrixXd turn(count, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    if (!(solver.eigenvalues()[k] > min_remaining_direction)) continue;
    turn.col(explained.degrees_of_freedom++) =
        scale.asDiagonal() * solver.eigenvectors().col(k) / std::sqrt(solver.eigenvalues()[k]);
  }
  const Eigen::MatrixXd normal = turn.leftCols(explained.degrees_of_freedom).transpose();
  explained.all = (normal * score).squaredNorm();
  explained.drawn = (normal * drawn).colwise().squaredNorm();
  return explained;
}

void StructureTest::add(const TestedVariable& variable, const Smooth& smooth) {
  if (smooth.columns() == 0) return;
  const std::vector<Eigen::MatrixXd> columns = columns_of(smooth, variable);
  const auto sums = partition_.all_reduce_flights<Eigen::MatrixXd>(
      [&](std::size_t f) { return products(f, columns[f]); }, partition_.threads());
  const Eigen::Index width = sums.cols() / as_index(whitened_.size());
  Structure structure;
  structure.variable = &variable;
  structure.name = variable.name;
  structure.unit = variable.unit;
  structure.description = variable.description;
  structure.sampling = variable.sampling;
  structure.centre = smooth.centre();
  double with_all = std::numeric_limits<double>::infinity();
  double with_line = with_all;
  Eigen::VectorXd with_drawn = Eigen::VectorXd::Constant(2 * draws, with_all);
  for (std::size_t k = 0; k < whitened_.size(); ++k) {
    const Whitened& flights = whitened_[k];
    const ExplainedSquares explained = explained_by(sums.middleCols(width * as_index(k), width), flights);
    if (explained.degrees_of_freedom == 0) return;
    const double degrees_of_freedom =
        std::max(1.0, static_cast<double>(rows_) - static_cast<double>(flights.inverse.rows()));
    const double variance = flights.squares / degrees_of_freedom;
    structure.degrees_of_freedom =
        std::max(structure.degrees_of_freedom, static_cast<double>(explained.degrees_of_freedom));
    if (const double value = minus_likelihood(flights, explained.all); value < with_all) {
      with_all = value;
      structure.r2 =
          std::max(0.0, explained.all / flights.squares -
                            static_cast<double>(explained.degrees_of_freedom) / degrees_of_freedom);
    }
    if (const double value = minus_likelihood(flights, explained.line);
        smooth.has_line() && explained.line > 0.0 && value < with_line) {
      with_line = value;
      structure.linear_r2 = std::max(0.0, explained.line / flights.squares - 1.0 / degrees_of_freedom);
      structure.slope = explained.line_score / explained.line_information / smooth.deviation();
      structure.slope_error = std::sqrt(variance / explained.line_information) / smooth.deviation();
    }
    for (Eigen::Index draw = 0; draw < 2 * draws; ++draw)
      with_drawn[draw] = std::min(with_drawn[draw], minus_likelihood(flights, explained.drawn[draw]));
  }
  structure.gain = alone_ - with_all;
  structure.line_gain = std::isfinite(with_line) ? alone_ - with_line : 0.0;
  const Eigen::VectorXd by_chance = alone_ - with_drawn.array();
  const double mean = std::max(by_chance.head(draws).mean(), by_chance.tail(draws).mean());
  const double unit = std::max(1.0, mean / structure.degrees_of_freedom);
  structure.chi2_one_dof = chi2_one_dof(structure.gain / unit, structure.degrees_of_freedom);
  for (Eigen::Index k = 0; k < 2 * draws; ++k) {
    // The one-degree equivalent never exceeds the value itself.
    if (by_chance[k] / unit <= largest_[k]) continue;
    largest_[k] = std::max(largest_[k], chi2_one_dof(by_chance[k] / unit, structure.degrees_of_freedom));
  }
  const double strong_columns = strong_.empty() ? 0.0 : static_cast<double>(strong_.front().cols());
  if (structure.gain - structure.degrees_of_freedom > strong_gain_ - strong_columns) {
    strong_gain_ = structure.gain;
    strong_ = columns;
  }
  structures_.push_back(structure);
}

double StructureTest::p_value() const {
  const auto strongest = std::max_element(
      structures_.begin(), structures_.end(),
      [](const Structure& a, const Structure& b) { return a.chi2_one_dof < b.chi2_one_dof; });
  return strongest == structures_.end() ? 1.0 : p_value_of(strongest->chi2_one_dof);
}

std::vector<Eigen::MatrixXd> StructureTest::strong_structure() const {
  constexpr double rare = 1e-4;
  if (strong_.empty()) return {};
  const double each = chi_squared_tail(strong_gain_, static_cast<double>(strong_.front().cols()));
  return each * static_cast<double>(structures_.size()) < rare ? strong_ : std::vector<Eigen::MatrixXd>();
}

double StructureTest::p_value_of(double chi2_one_dof) const {
  return std::max(p_value_among(chi2_one_dof, largest_.head(draws)),
                  p_value_among(chi2_one_dof, largest_.tail(draws)));
}

bool ChangeSlope::is_correlated() const {
  constexpr double level = 0.12;
  return std::abs(correlation) > level;
}

bool ChangeSlope::agrees_with(const Structure& structure) const {
  constexpr double seen = 5.0;       // standard errors
  constexpr double certain = 3.0;    // standard errors
  constexpr double tolerance = 0.2;  // the recorded variable and the residual are filtered and delayed
  if (!(std::abs(structure.slope) > seen * structure.slope_error)) return false;
  const double allowed =
      certain * std::hypot(error, structure.slope_error) + tolerance * std::abs(structure.slope);
  return std::abs(slope - structure.slope) < allowed;
}

ChangeSlope slope_of_changes(const FlightPartition& partition,
                             const std::vector<std::vector<double>>& residuals,
                             const TestedVariable& variable) {
  constexpr std::size_t window = 300;
  constexpr std::size_t fewest = 60;
  using Parts = std::vector<std::array<double, 2>>;  // correlation and slope of each part
  const auto of_flights = partition.all_gather_flights<Parts>([&](std::size_t f) {
    Parts parts;
    const std::vector<double>& residual = residuals[f];
    const std::vector<double>& values = *variable.values[f];
    for (std::size_t first = 1; first < residual.size(); first += window) {
      double rr = 0.0;
      double vv = 0.0;
      double rv = 0.0;
      std::size_t count = 0;
      for (std::size_t i = first; i < std::min(first + window, residual.size()); ++i) {
        const double change = residual[i] - residual[i - 1];
        const double other = values[i] - values[i - 1];
        if (!std::isfinite(change) || !std::isfinite(other)) continue;
        rr += change * change;
        vv += other * other;
        rv += change * other;
        ++count;
      }
      if (count < fewest) continue;
      const bool varies = rr > 0.0 && vv > 0.0;
      parts.push_back({varies ? rv / std::sqrt(rr * vv) : 0.0, varies ? rv / vv : 0.0});
    }
    return parts;
  });
  std::vector<double> correlations;
  std::vector<double> slopes;
  for (const Parts& parts : of_flights) {
    for (const auto& [correlation, slope] : parts) {
      correlations.push_back(correlation);
      slopes.push_back(slope);
    }
  }
  ChangeSlope result;
  if (slopes.empty()) return result;
  result.correlation = median(std::move(correlations));
  result.slope = median(slopes);
  for (double& slope : slopes) slope -= result.slope;
  constexpr double of_median = 1.2533141373;  // error of a median / that of a mean
  const auto count = static_cast<double>(slopes.size());
  result.error = of_median / std::sqrt(count) * robust_standard_deviation(std::move(slopes));
  return result;
}

}  // namespace pcor::internal
