#include "diagnose/what_if_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <pcor/numerics/noise.hpp>
#include "diagnose/analysis.hpp"
#include "diagnose/scores.hpp"
#include "diagnose/separation.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"
#include "numerics/robust_weights.hpp"
#include "numerics/spikes.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

// Of noise and coefficients in turn, as in a refit: the noise without slow parts and a loss of which the
// minimum is unique come first.
constexpr int rounds = 2;
constexpr double least_eigenvalue = 1e-11;

using Places = std::vector<Eigen::Index>;

/// What changes of the coefficients of base and candidates take off the residual of a record.
double taken_off(const FlightColumns& flight, std::size_t record, const Eigen::VectorXd& values) {
  const Eigen::Index row = as_index(record);
  return flight.base.row(row).cast<double>().dot(values.head(flight.base.cols())) +
         flight.candidates.row(row).cast<double>().dot(values.tail(flight.candidates.cols()));
}

/// A residual of a flight without its outliers: samples that depart from those around them.
std::vector<double> calm(const FlightColumns& flight, const std::vector<double>& residual,
                         const Eigen::VectorXd& values) {
  std::vector<double> left(residual.size(), nan);
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (!std::isnan(residual[i])) left[i] = residual[i] - taken_off(flight, i, values);
  }
  const std::vector<double> nothing(left.size(), 0.0);
  std::size_t count = 0;
  const std::vector<double> without =
      without_outliers(left, nothing, flight.samples->time, flight.samples->step, count);
  std::vector<double> result = residual;
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (!(without[i] == left[i])) result[i] = nan;
  }
  return result;
}

/// The coefficients of some columns that leave least, the others as they are.
Eigen::VectorXd solved(const Eigen::MatrixXd& sum, const Places& free, Eigen::VectorXd values) {
  values(free).setZero();
  const Eigen::Index width = values.size();
  const Eigen::VectorXd right = sum.col(width).head(width) - sum.topLeftCorner(width, width) * values;
  values(free) = pseudo_solution(sum(free, free), right(free), least_eigenvalue);
  return values;
}

/// What is left of whitened residuals, in units of its robust deviation.
std::vector<Eigen::VectorXd> in_deviations(const std::vector<Eigen::MatrixXd>& rows,
                                           const Eigen::VectorXd& values) {
  std::vector<Eigen::VectorXd> left;
  std::vector<double> all;
  for (const Eigen::MatrixXd& part : rows) {
    left.emplace_back(part.rightCols(1) - part.leftCols(values.size()) * values);
    all.insert(all.end(), left.back().begin(), left.back().end());
  }
  const double deviation = std::max(robust_deviation(std::move(all)), 1e-300);
  for (Eigen::VectorXd& part : left) part /= deviation;
  return left;
}

/// Gives the rows the weights of a loss at its minimum, which `values` become.
void weigh(Scores& scores, const Places& free, Eigen::VectorXd& values, double (*weight)(double)) {
  constexpr int most_steps = 50;
  constexpr double enough = 1e-3;  // of what the flights leave open
  const std::vector<Eigen::MatrixXd> rows = scores.rows;
  for (int step = 0; step < most_steps; ++step) {
    const std::vector<Eigen::VectorXd> ratios = in_deviations(rows, values);
    for (std::size_t f = 0; f < rows.size(); ++f)
      scores.rows[f] = ratios[f].unaryExpr(weight).cwiseSqrt().asDiagonal() * rows[f];
    sum_up(scores);
    const Eigen::VectorXd before = values;
    values = solved(scores.information, free, values);
    const Eigen::VectorXd length = scores.information.diagonal().head(values.size()).cwiseSqrt();
    if (length.cwiseProduct(values - before).cwiseAbs().maxCoeff() < enough) return;
  }
}

/// By how much the variances of a fit with Tukey's loss are larger than those of least squares of the rows
/// with its weights (Huber and Ronchetti 2009, Robust Statistics, section 7.6). @param rows without weights
double inflation_by_weights(const std::vector<Eigen::MatrixXd>& rows, const Eigen::VectorXd& values) {
  double count = 0.0;
  double weights = 0.0;
  double slopes = 0.0;
  double squares = 0.0;
  double weighted_squares = 0.0;
  for (const Eigen::VectorXd& ratios : in_deviations(rows, values)) {
    for (const double ratio : ratios) {
      const double weight = tukey_weight(ratio);
      count += 1.0;
      weights += weight;
      slopes += tukey_slope(ratio);
      squares += weight * weight * ratio * ratio;
      weighted_squares += weight * ratio * ratio;
    }
  }
  return count * weights * squares / (slopes * slopes) / weighted_squares;
}

/// Which of some groups a reader may have switched on: all subsets of a few; of many what comes first, as
/// they were found one after another. The empty one first, all of them last.
std::vector<std::vector<std::size_t>> subsets_of(const std::vector<std::size_t>& groups) {
  constexpr std::size_t few = 3;
  std::vector<std::vector<std::size_t>> subsets;
  if (groups.size() > few) {
    for (std::size_t count = 0; count <= groups.size(); ++count)
      subsets.emplace_back(groups.begin(), groups.begin() + static_cast<std::ptrdiff_t>(count));
    return subsets;
  }
  for (std::size_t bits = 0; bits < std::size_t{1} << groups.size(); ++bits) {
    std::vector<std::size_t>& subset = subsets.emplace_back();
    for (std::size_t i = 0; i < groups.size(); ++i) {
      if ((bits >> i & 1U) != 0U) subset.push_back(groups[i]);
    }
  }
  return subsets;
}

void add(SumOfProducts& sum, const Eigen::VectorXd& row) {
  if (sum.products.size() == 0) sum.products = Eigen::MatrixXd::Zero(row.size(), row.size());
  sum.products.selfadjointView<Eigen::Lower>().rankUpdate(row);
  sum.count += 1.0;
}

}  // namespace

WhatIfFit::WhatIfFit(std::vector<FlightColumns> flights, std::vector<FlightColumns> others,
                     const std::vector<WhatIfCoefficient>& coefficients, std::vector<ColumnGroup> groups,
                     const std::vector<std::size_t>& found, bool is_robust, const ResidualAt& residual_at)
    : flights_(std::move(flights)), others_(std::move(others)), groups_(std::move(groups)) {
  base_ = flights_.front().base.cols();
  given_.resize(as_index(coefficients.size()));
  start_.resize(given_.size());
  for (Eigen::Index c = 0; c < given_.size(); ++c) {
    const WhatIfCoefficient& coefficient = coefficients[static_cast<std::size_t>(c)];
    start_[c] = coefficient.start;
    given_[c] = coefficient.given - coefficient.start;
    if (c < base_ && !coefficient.fixed) own_.push_back(c);
  }
  for (std::vector<FlightColumns>* all : {&flights_, &others_}) {
    for (FlightColumns& flight : *all) {
      for (std::size_t i = 0; i < flight.given.size(); ++i)
        flight.given[i] += flight.base.row(as_index(i)).cast<double>().dot(given_.head(base_));
    }
  }
  for (const ColumnGroup& group : groups_) told_.push_back(places_of(group, base_));
  for (const std::vector<std::size_t>& some : subsets_of(found)) settle(some, is_robust, residual_at);
}

/// Where slow noise makes the fit leave more than the coefficients that are given, it is no noise but what
/// the model lacks, and the fit follows it, as a refit does.
void WhatIfFit::settle(const std::vector<std::size_t>& found, bool is_robust, const ResidualAt& residual_at) {
  constexpr double larger = 1.02;
  weights_.push_back({found, {}, 1.0});
  const Eigen::VectorXd with_drift = find_sums(found, is_robust, true, residual_at);
  sum_records();
  if (rms_of(with_drift) > larger * rms_of(given_)) {
    find_sums(found, is_robust, false, residual_at);
    sum_records();
  }
  weights_.back().inflation = inflation_;
}

std::vector<Eigen::Index> WhatIfFit::free_columns(const std::vector<std::size_t>& groups) const {
  Places free = own_;
  for (const std::size_t group : groups) free.insert(free.end(), told_[group].begin(), told_[group].end());
  return free;
}

/// The residual at the start, such that a step by the derivatives leads to what it really is at `values`.
std::vector<double> WhatIfFit::residual_for(const FlightColumns& flight,
                                            const std::vector<std::size_t>& groups,
                                            const Eigen::VectorXd& values,
                                            const ResidualAt& residual_at) const {
  const std::vector<double> there = residual_at(flight, groups, start_ + values);
  if (there.empty()) return flight.given;
  std::vector<double> residual = flight.given;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (!std::isnan(residual[i])) residual[i] = there[i] + taken_off(flight, i, values);
  }
  return residual;
}

Eigen::VectorXd WhatIfFit::find_sums(const std::vector<std::size_t>& found, bool is_robust, bool drifts,
                                     const ResidualAt& residual_at) {
  Eigen::VectorXd values = given_;
  Scores scores;
  std::vector<NoiseModel> noise;
  for (int round = 0; round <= rounds; ++round) {
    bins_.clear();
    std::vector<Eigen::MatrixXd> columns;
    std::vector<Eigen::VectorXd> residuals;
    for (const FlightColumns& flight : flights_) {
      std::vector<double> series =
          round > 0 ? residual_for(flight, found, values, residual_at) : flight.given;
      if (is_robust && round > 0) series = calm(flight, series, values);
      bins_.emplace_back(series, flight.samples->time, flight.samples->step,
                         std::max(flight.window, Binning::usual_width));
      columns.push_back(binned_columns(flight, bins_.back()));
      residuals.push_back(bins_.back().means(series));
    }
    if (round == 0) {
      scores.share = FlightShare(flights_.size());
      scores.rows.clear();
      for (std::size_t f = 0; f < flights_.size(); ++f)
        scores.rows.emplace_back(columns[f].rows(), columns[f].cols() + 1) << columns[f], residuals[f];
      sum_up(scores);
      values = solved(scores.information, free_columns(found), values);
      continue;
    }
    const Places free = free_columns(found);
    noise.resize(flights_.size());
    for (std::size_t first = 0; first < flights_.size();) {
      std::vector<Binning> bins;
      std::vector<Eigen::MatrixXd> fitted;
      std::vector<Eigen::VectorXd> left;
      std::size_t last = first;
      for (; last < flights_.size() && flights_[last].reference == flights_[first].reference; ++last) {
        bins.push_back(bins_[last]);
        fitted.emplace_back(columns[last](Eigen::all, free));
        left.emplace_back(residuals[last] - columns[last] * values);
      }
      const NoiseModel model =
          drifts && round == rounds ? find_noise(bins, fitted, left).model : estimate_noise(bins, left);
      if (first == 0) noise_ = model;
      for (; first < last; ++first) {
        noise[first] = model;
        noise[first].level = {model.level[first - (last - bins.size())]};
      }
    }
    scores = find_scores(FlightShare(bins_.size()), bins_, columns, residuals, noise);
    const Search search(scores, base_, groups_);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      told_[g].clear();
      for (const Eigen::Index column : search.told(g)) told_[g].push_back(base_ + groups_[g].first + column);
    }
    values = solved(scores.information, free_columns(found), values);
    if (!is_robust) continue;
    const std::vector<Eigen::MatrixXd> rows = scores.rows;
    weigh(scores, free_columns(found), values, round < rounds ? huber_weight : tukey_weight);
    inflation_ = inflation_by_weights(rows, values);
  }
  std::vector<SumOfProducts>& parts = weights_.back().parts;
  parts.assign(held_out_parts, {});
  for (std::size_t f = 0; f < flights_.size(); ++f) {
    for (std::size_t i = 0; i < bins_[f].size(); ++i) {
      const std::size_t part = held_out_part(*flights_[f].samples, bins_[f].time()[i]);
      add(parts[part], scores.rows[f].row(as_index(i)).transpose());
    }
  }
  for (SumOfProducts& part : parts) {
    if (part.count == 0.0) part.products = Eigen::MatrixXd::Zero(given_.size() + 1, given_.size() + 1);
    part.products = part.products.selfadjointView<Eigen::Lower>();
  }
  whole_.products = scores.information;
  whole_.count = static_cast<double>(scores.row_count);
  return values;
}

/// Over all samples that take part.
double WhatIfFit::rms_of(const Eigen::VectorXd& values) const {
  Eigen::VectorXd change(values.size() + 1);
  change << -values, 1.0;
  double squares = 0.0;
  double count = 0.0;
  const auto add = [&](const SumOfProducts& sum) {
    squares += change.dot(sum.products.selfadjointView<Eigen::Lower>() * change);
    count += sum.count;
  };
  for (const SumOfProducts& part : alike_) add(part);
  add(outliers_);
  return std::sqrt(squares / count);
}

void WhatIfFit::sum_records() {
  const Eigen::Index width = given_.size() + 1;
  const SumOfProducts nothing{Eigen::MatrixXd::Zero(width, width), 0.0};
  alike_.assign(held_out_parts, nothing);
  outliers_ = held_out_ = nothing;
  const auto row_of = [width](const FlightColumns& flight, std::size_t record) {
    Eigen::VectorXd row(width);
    row << flight.base.row(as_index(record)).cast<double>().transpose(),
        flight.candidates.row(as_index(record)).cast<double>().transpose(), flight.given[record];
    return row;
  };
  for (std::size_t f = 0; f < flights_.size(); ++f) {
    const FlightColumns& flight = flights_[f];
    if (flight.reference != 0) continue;
    std::vector<bool> counts(flight.given.size(), false);
    for (const std::size_t record : bins_[f].records()) counts[record] = true;
    for (std::size_t i = 0; i < flight.given.size(); ++i) {
      if (std::isnan(flight.given[i])) continue;
      SumOfProducts& part = alike_[held_out_part(*flight.samples, flight.samples->time[i])];
      add(counts[i] ? part : outliers_, row_of(flight, i));
    }
  }
  for (const FlightColumns& flight : others_) {
    for (std::size_t i = 0; i < flight.given.size(); ++i) {
      const Eigen::VectorXd row = row_of(flight, i);
      if (row.allFinite()) add(held_out_, row);
    }
  }
}

Eigen::MatrixXd WhatIfFit::information() const {
  return whole_.products.topLeftCorner(given_.size(), given_.size());
}

double WhatIfFit::variance(const std::vector<std::size_t>& groups) const {
  const Places free = free_columns(groups);
  Eigen::VectorXd change(given_.size() + 1);
  change << -solved(whole_.products, free, given_), 1.0;
  return inflation_ * change.dot(whole_.products * change) /
         std::max(whole_.count - static_cast<double>(free.size()), 1.0);
}

WhatIfFit::Fitted WhatIfFit::fitted(const std::vector<std::size_t>& groups) const {
  const Places free = free_columns(groups);
  Fitted result{solved(whole_.products, free, given_), Eigen::VectorXd::Zero(given_.size())};
  const Eigen::MatrixXd normal = whole_.products(free, free);
  const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inverse =
      pseudo_inverse(Eigen::MatrixXd(scale.asDiagonal() * normal * scale.asDiagonal()), least_eigenvalue);
  result.errors(free) =
      std::sqrt(variance(groups)) * inverse.diagonal().cwiseMax(0.0).cwiseSqrt().cwiseProduct(scale);
  return result;
}

void WhatIfFit::describe(std::vector<WhatIfCoefficient>& coefficients) const {
  constexpr double surely = 2.0;  // errors
  const Fitted none = fitted({});
  const auto grow = [&coefficients](Eigen::Index c, double size) {
    double& known = coefficients[static_cast<std::size_t>(c)].size;
    known = std::max(known, size);
  };
  for (const Eigen::Index c : own_) grow(c, surely * none.errors[c]);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const Fitted with = fitted({g});
    for (const Eigen::Index c : own_) grow(c, std::abs(with.values[c] - none.values[c]));
    for (Eigen::Index k = 0; k < groups_[g].count; ++k)
      coefficients[static_cast<std::size_t>(base_ + groups_[g].first + k)].fixed = true;
    for (const Eigen::Index c : told_[g]) {
      coefficients[static_cast<std::size_t>(c)].fixed = false;
      grow(c, std::abs(with.values[c]) + surely * with.errors[c]);
    }
  }
}

}  // namespace pcor::internal
