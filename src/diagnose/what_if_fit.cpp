#include "diagnose/what_if_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include <pcor/numerics/noise.hpp>
#include "diagnose/analysis.hpp"
#include "diagnose/separation.hpp"
#include "diagnose/whitened_system.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/median.hpp"
#include "numerics/missing.hpp"
#include "numerics/noise_covariance.hpp"
#include "numerics/robust_weights.hpp"
#include "numerics/spikes.hpp"
#include "numerics/triangular_factor.hpp"
#include "parallel/distributed_median.hpp"
#include "parallel/workers.hpp"

namespace pcor::internal {
namespace {

// Alternating fit of noise and coefficients as in refit: noise without slow parts and a loss with a unique
// minimum come first.
constexpr int rounds = 2;
constexpr double min_eigenvalue = 1e-11;

using Places = std::vector<Eigen::Index>;

/// Change of the residual of a record by changed coefficients of base and candidates.
double taken_off(const FlightColumns& flight, std::size_t record, const Eigen::VectorXd& values) {
  const Eigen::Index row = as_index(record);
  return flight.base.row(row).cast<double>().dot(values.head(flight.base.cols())) +
         flight.candidates.row(row).cast<double>().dot(values.tail(flight.candidates.cols()));
}

/// Residual of a flight without outliers, i.e. samples that depart from their neighbours.
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

/// Least-squares coefficients of some columns, with the others fixed.
Eigen::VectorXd solved(const Eigen::MatrixXd& sum, const Places& free, Eigen::VectorXd values) {
  values(free).setZero();
  const Eigen::Index width = values.size();
  const Eigen::VectorXd right = sum.col(width).head(width) - sum.topLeftCorner(width, width) * values;
  values(free) = pseudo_solution(sum(free, free), right(free), min_eigenvalue);
  return values;
}

/// Whitened residuals of local flights, in units of the robust deviation over all flights.
std::vector<Eigen::VectorXd> in_deviations(const FlightPartition& share,
                                           const std::vector<Eigen::MatrixXd>& rows,
                                           const Eigen::VectorXd& values) {
  std::vector<Eigen::VectorXd> left;
  std::vector<double> all;
  for (const Eigen::MatrixXd& part : rows) {
    left.emplace_back();
    if (part.size() == 0) continue;
    left.back() = part.rightCols(1) - part.leftCols(values.size()) * values;
    all.insert(all.end(), left.back().begin(), left.back().end());
  }
  const double deviation =
      std::max(deviation_of_median * median_of_absolute_values(share.comm(), std::move(all)), 1e-300);
  for (Eigen::VectorXd& part : left) part /= deviation;
  return left;
}

/// Gives the rows the weights of Huber's loss at its minimum, and sets `values` to the minimum.
void weigh(WhitenedSystem& scores, const Places& free, Eigen::VectorXd& values) {
  constexpr int max_steps = 50;
  constexpr double enough = 1e-3;  // fraction of the uncertainty from the flights
  const std::vector<Eigen::MatrixXd> rows = scores.rows;
  for (int step = 0; step < max_steps; ++step) {
    const std::vector<Eigen::VectorXd> ratios = in_deviations(scores.share, rows, values);
    for (std::size_t f = 0; f < rows.size(); ++f)
      scores.rows[f] = ratios[f].unaryExpr(&huber_weight).cwiseSqrt().asDiagonal() * rows[f];
    sum_up(scores);
    const Eigen::VectorXd before = values;
    values = solved(scores.information, free, values);
    const Eigen::VectorXd length = scores.information.diagonal().head(values.size()).cwiseSqrt();
    if (length.cwiseProduct(values - before).cwiseAbs().maxCoeff() < enough) return;
  }
}

/// Subsets of groups that a reader may select: all subsets of a few groups; for many, the first ones in the
/// order of discovery. The empty subset comes first, the full one last.
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
  sum.products.selfadjointView<Eigen::Lower>().rankUpdate(row);
  sum.count += 1.0;
}

/// Sums of several kinds of samples; sums of flights can be added.
struct SumsOfProducts {
  std::vector<SumOfProducts> kinds{};

  SumsOfProducts() = default;
  SumsOfProducts(std::size_t count, Eigen::Index width)
      : kinds(count, SumOfProducts{Eigen::MatrixXd::Zero(width, width), 0.0}) {}

  SumsOfProducts& operator+=(const SumsOfProducts& other) {
    for (std::size_t k = 0; k < kinds.size(); ++k) kinds[k] += other.kinds[k];
    return *this;
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(kinds);
  }
};

/// Base, candidates and residual of a record.
Eigen::VectorXd row_of(const FlightColumns& flight, std::size_t record) {
  Eigen::VectorXd row(flight.base.cols() + flight.candidates.cols() + 1);
  row << flight.base.row(as_index(record)).cast<double>().transpose(),
      flight.candidates.row(as_index(record)).cast<double>().transpose(), flight.given[record];
  return row;
}

}  // namespace

SumOfProducts& SumOfProducts::operator+=(const SumOfProducts& other) {
  products += other.products;
  count += other.count;
  return *this;
}

WhatIfFit::WhatIfFit(TeamColumns flights, TeamColumns others,
                     const std::vector<WhatIfCoefficient>& coefficients, std::vector<ColumnGroup> groups,
                     const std::vector<std::size_t>& found, bool is_robust, const ResidualWith& residual_with)
    : flights_(std::move(flights)), others_(std::move(others)), groups_(std::move(groups)) {
  base_ = flights_.flights.front().base.cols();
  given_.resize(as_index(coefficients.size()));
  start_.resize(given_.size());
  for (Eigen::Index c = 0; c < given_.size(); ++c) {
    const WhatIfCoefficient& coefficient = coefficients[static_cast<std::size_t>(c)];
    start_[c] = coefficient.start;
    given_[c] = coefficient.given - coefficient.start;
    if (c < base_ && !coefficient.fixed) own_.push_back(c);
  }
  for (TeamColumns* all : {&flights_, &others_}) {
    for (FlightColumns& flight : all->flights) {
      for (std::size_t i = 0; i < flight.given.size(); ++i)
        flight.given[i] += flight.base.row(as_index(i)).cast<double>().dot(given_.head(base_));
    }
  }
  sum_held_out();
  for (const ColumnGroup& group : groups_) told_.push_back(places_of(group, base_));
  for (const std::vector<std::size_t>& some : subsets_of(found)) settle(some, is_robust, residual_with);
}

void WhatIfFit::settle(const std::vector<std::size_t>& found, bool is_robust,
                       const ResidualWith& residual_with) {
  std::vector<std::optional<ResidualAt>> residuals(flights_.flights.size());
  const auto residual_of = [&](std::size_t f) -> const ResidualAt& {
    if (!residuals[f]) residuals[f] = residual_with(flights_.flights[f], found);
    return *residuals[f];
  };
  weights_.push_back({found, {}, {}});
  find_sums(found, is_robust, residual_of);
  sum_records();
}

std::vector<Eigen::Index> WhatIfFit::free_columns(const std::vector<std::size_t>& groups) const {
  Places free = own_;
  for (const std::size_t group : groups) free.insert(free.end(), told_[group].begin(), told_[group].end());
  return free;
}

/// Residual at the start, chosen so that a step by the derivatives gives the exact residual at `values`.
std::vector<double> WhatIfFit::residual_for(const FlightColumns& flight, const Eigen::VectorXd& values,
                                            const ResidualAt& residual_at) const {
  const std::vector<double> there = residual_at ? residual_at(start_ + values) : std::vector<double>();
  if (there.empty()) return flight.given;
  std::vector<double> residual = flight.given;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (!std::isnan(residual[i])) residual[i] = there[i] + taken_off(flight, i, values);
  }
  return residual;
}

void WhatIfFit::find_sums(const std::vector<std::size_t>& found, bool is_robust,
                          const std::function<const ResidualAt&(std::size_t)>& residual_of) {
  const FlightPartition& share = flights_.share;
  const std::vector<FlightColumns>& flights = flights_.flights;
  Eigen::VectorXd values = given_;
  WhitenedSystem scores;
  WhitenedSystem with_noise;
  std::vector<NoiseModel> noise;
  for (int round = 0; round <= rounds; ++round) {
    binned_ = in_bins(share, flights, [&](std::size_t f) {
      if (round == 0) return flights[f].given;
      const std::vector<double> residual = residual_for(flights[f], values, residual_of(f));
      return is_robust ? calm(flights[f], residual, values) : residual;
    });
    if (round == 0) {
      scores.share = share;
      scores.rows.clear();
      for (std::size_t f = 0; f < flights.size(); ++f) {
        const Eigen::MatrixXd& columns = binned_.columns[f];
        scores.rows.emplace_back(columns.rows(), columns.cols() + 1) << columns, binned_.residuals[f];
      }
      sum_up(scores);
      values = solved(scores.information, free_columns(found), values);
      continue;
    }
    noise = noise_after(values, free_columns(found), round == rounds);
    with_noise = find_scores(share, binned_.bins, binned_.columns, binned_.residuals, noise);
    const Search search(with_noise, base_, groups_);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      told_[g].clear();
      for (const Eigen::Index column : search.told(g)) told_[g].push_back(base_ + groups_[g].first + column);
    }
    scores =
        find_scores(share, binned_.bins, binned_.columns, binned_.residuals, weights_after(values, noise));
    values = solved(scores.information, free_columns(found), values);
    if (!is_robust) continue;
    weigh(scores, free_columns(found), values);
  }
  weights_.back().score_covariance = share.sum_of_each_flight<Eigen::MatrixXd>(
      [&](std::size_t f) { return score_covariance(f, scores.rows[f], noise[f]); });
  std::vector<SumOfProducts>& parts = weights_.back().parts;
  parts = share
              .sum_of_each_flight<SumsOfProducts>([&](std::size_t f) {
                SumsOfProducts sums(held_out_parts, given_.size() + 1);
                for (std::size_t i = 0; i < binned_.bins[f].size(); ++i) {
                  const std::size_t part = held_out_part(*flights[f].samples, binned_.bins[f].time()[i]);
                  add(sums.kinds[part], scores.rows[f].row(as_index(i)).transpose());
                }
                return sums;
              })
              .kinds;
  for (SumOfProducts& part : parts) part.products = part.products.selfadjointView<Eigen::Lower>();
  regimes_ = flown_regimes(with_noise, [&](std::size_t f) {
    return FlightInBins{flights[f], binned_.bins[f]};
  });
  whole_.products = scores.information;
  whole_.count = static_cast<double>(scores.row_count);
  with_noise_.products = with_noise.information;
  with_noise_.count = static_cast<double>(with_noise.row_count);
}

/// Covariance of the scores of a flight, i.e. weighted columns' residual. @param rows weighted
Eigen::MatrixXd WhatIfFit::score_covariance(std::size_t flight, const Eigen::MatrixXd& rows,
                                            const NoiseModel& noise) const {
  const Eigen::MatrixXd& columns = binned_.columns[flight];
  // References of many samples have uncorrelated rows of unit variance.
  if (flights_.flights[flight].window > 0.0) {
    const Eigen::MatrixXd own = rows.leftCols(columns.cols());
    return own.transpose() * own;
  }
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(columns.rows());
  for (Eigen::Index i = 0; i < weight.size(); ++i) {
    const double squares = columns.row(i).squaredNorm() + std::pow(binned_.residuals[flight][i], 2);
    if (squares > 0.0) weight[i] = rows.row(i).squaredNorm() / squares;
  }
  if (weight.size() == 0) return Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
  return noise_covariance(weight.asDiagonal() * columns, binned_.bins[flight], noise, 0);
}

/// The weights of a refit, as noise without memory: by the root of the samples in a bin over the deviation of
/// the residuals against its reference. References of many samples have their noise.
std::vector<NoiseModel> WhatIfFit::weights_after(const Eigen::VectorXd& values,
                                                 std::vector<NoiseModel> noise) const {
  for (std::size_t first = 0; first < noise.size();) {
    std::size_t last = first;
    std::vector<double> left;
    for (; last < noise.size() && binned_.reference[last] == binned_.reference[first]; ++last) {
      const Eigen::VectorXd own = binned_.residuals[last] - binned_.columns[last] * values;
      left.insert(left.end(), own.begin(), own.end());
    }
    const bool is_of_one_sample = !(flights_.flights[first].window > 0.0);
    double deviation =
        deviation_of_median * median_of_absolute_values(flights_.share.comm(), std::move(left));
    if (!(deviation > 0.0)) deviation = 1.0;
    for (; first < last; ++first) {
      if (!is_of_one_sample) continue;
      noise[first] = {};
      const Eigen::VectorXd counts = binned_.bins[first].counts();
      noise[first].level = {
          counts.size() > 0
              ? Eigen::VectorXd(deviation * (counts / counts.maxCoeff()).cwiseSqrt().cwiseInverse())
              : counts};
    }
  }
  return noise;
}

std::vector<NoiseModel> WhatIfFit::noise_after(const Eigen::VectorXd& values, const Places& free,
                                               bool drifts) const {
  const std::size_t threads = Workers(flights_.share.comm(), 0).threads;
  return noise_of_flights(
      flights_.share, binned_,
      {[&](std::size_t f) -> Eigen::MatrixXd { return binned_.columns[f](Eigen::all, free); },
       [&](std::size_t f) -> Eigen::VectorXd { return binned_.residuals[f] - binned_.columns[f] * values; },
       digest_of(packed(values))},
      [&](const auto& bins, const auto& fitted, const auto& left) {
        return drifts ? find_noise(bins, fitted, left, threads).model : estimate_noise(bins, left);
      });
}

void WhatIfFit::sum_records() {
  const Eigen::Index width = given_.size() + 1;
  // Behind the parts the outliers.
  alike_ = flights_.share
               .sum_of_each_flight<SumsOfProducts>([&](std::size_t f) {
                 const FlightColumns& flight = flights_.flights[f];
                 SumsOfProducts sums(held_out_parts + 1, width);
                 if (flight.reference != 0) return sums;
                 std::vector<bool> counts(flight.given.size(), false);
                 for (const std::size_t record : binned_.bins[f].records()) counts[record] = true;
                 for (std::size_t i = 0; i < flight.given.size(); ++i) {
                   if (std::isnan(flight.given[i])) continue;
                   const std::size_t part = held_out_part(*flight.samples, flight.samples->time[i]);
                   add(sums.kinds[counts[i] ? part : held_out_parts], row_of(flight, i));
                 }
                 return sums;
               })
               .kinds;
  outliers_ = std::move(alike_.back());
  alike_.pop_back();
}

void WhatIfFit::sum_held_out() {
  const Eigen::Index width = given_.size() + 1;
  held_out_ = others_.share.sum_of_each_flight<SumOfProducts>([&](std::size_t f) {
    const FlightColumns& flight = others_.flights[f];
    SumOfProducts sum{Eigen::MatrixXd::Zero(width, width), 0.0};
    for (std::size_t i = 0; i < flight.given.size(); ++i) {
      const Eigen::VectorXd row = row_of(flight, i);
      if (row.allFinite()) add(sum, row);
    }
    return sum;
  });
}

Eigen::MatrixXd WhatIfFit::information() const {
  return with_noise_.products.topLeftCorner(given_.size(), given_.size());
}

double WhatIfFit::variance(const std::vector<std::size_t>& groups) const {
  const Places free = free_columns(groups);
  Eigen::VectorXd change(given_.size() + 1);
  change << -solved(with_noise_.products, free, given_), 1.0;
  return change.dot(with_noise_.products * change) /
         std::max(with_noise_.count - static_cast<double>(free.size()), 1.0);
}

WhatIfFit::Fitted WhatIfFit::fitted(const std::vector<std::size_t>& groups) const {
  const Places free = free_columns(groups);
  Fitted result{solved(whole_.products, free, given_), Eigen::VectorXd::Zero(given_.size())};
  const Eigen::MatrixXd normal = with_noise_.products(free, free);
  const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inverse =
      pseudo_inverse(Eigen::MatrixXd(scale.asDiagonal() * normal * scale.asDiagonal()), min_eigenvalue);
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
