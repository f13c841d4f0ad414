#include "diagnose/what_if_fit.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "campaign/linear_rows.hpp"
#include "campaign/model_parameters.hpp"
#include "diagnose/analysis.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"
#include "numerics/noise_covariance.hpp"
#include "numerics/robust_weights.hpp"
#include "numerics/spikes.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

using Indices = std::vector<Eigen::Index>;

/// Change of the residual of a record by changed coefficients of base and candidates.
double taken_off(const FlightColumns& flight, std::size_t record, const Eigen::VectorXd& values) {
  const Eigen::Index row = as_index(record);
  return flight.base.row(row).cast<double>().dot(values.head(flight.base.cols())) +
         flight.candidates.row(row).cast<double>().dot(values.tail(flight.candidates.cols()));
}

/// Residual of a flight without outliers, i.e. samples that depart from their neighbours.
std::vector<double> calm(const FlightColumns& flight, const std::vector<double>& residual,
                         const Eigen::VectorXd& values) {
  std::vector<double> predicted(residual.size());
  for (std::size_t i = 0; i < predicted.size(); ++i) predicted[i] = taken_off(flight, i, values);
  std::size_t count = 0;
  std::vector<double> result =
      without_outliers(residual, predicted, flight.samples->time, flight.samples->step, count);
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (result[i] != residual[i]) result[i] = nan;
  }
  return result;
}

/// Least-squares coefficients of some columns, with the others fixed.
Eigen::VectorXd solved(const Eigen::MatrixXd& sum, const Indices& free, Eigen::VectorXd values) {
  values(free).setZero();
  const Eigen::Index width = values.size();
  const Eigen::VectorXd right = sum.col(width).head(width) - sum.topLeftCorner(width, width) * values;
  values(free) = pseudo_solution(sum(free, free), right(free));
  return values;
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

/// Base, candidates and residual of a record.
Eigen::VectorXd row_of(const FlightColumns& flight, std::size_t record) {
  Eigen::VectorXd row(flight.base.cols() + flight.candidates.cols() + 1);
  row << flight.base.row(as_index(record)).cast<double>().transpose(),
      flight.candidates.row(as_index(record)).cast<double>().transpose(), flight.given[record];
  return row;
}

/// Residual of a flight with effects at large coefficients, as a refit with them computes it.
ResidualAt residual_with(const ModelDefinition& model, const CandidateSet& set, const FlightColumns& flight,
                         const std::vector<std::size_t>& groups) {
  const Reference& reference = *set.references[flight.reference];
  if (!reference.is_of_one_sample()) return {};
  ModelDefinition with = model;
  with.variables = set.extended.variables;
  with.units = set.extended.units;
  // Residual parameter of each free coefficient, and its index in the panel.
  std::vector<std::size_t> free = free_parameters(model);
  std::vector<std::size_t> number(free.size());
  std::iota(number.begin(), number.end(), 0);
  for (const std::size_t group : groups) {
    const Candidate& candidate = set.candidates[group];
    if (candidate.is_shared || candidate.is_of_reference() || candidate.memory != 0.0) return {};
    for (std::size_t k = 0; k < candidate.tested.size(); ++k) {
      free.push_back(parameter_count(with.model) + candidate.tested[k].index);
      number.push_back(set.base.size() + set.first_column(group) + k);
    }
    with.model.effects.push_back(candidate.effect);
  }
  with.fits.resize(with.model.effects.size());
  std::vector<std::size_t> records;
  for (std::size_t i = 0; i < flight.given.size(); ++i) {
    if (!std::isnan(flight.given[i])) records.push_back(i);
  }
  const auto rows =
      std::make_shared<const LinearRows>(Residuals(flight.samples, with, reference, flight.mask), with,
                                         reference, RowsSetup{Inputs::none, free});
  return [=](const Eigen::VectorXd& values) -> std::vector<double> {
    std::vector<double> parameters = rows->residuals().parameters();
    for (std::size_t k = 0; k < free.size(); ++k) parameters[free[k]] = values[as_index(number[k])];
    const Eigen::VectorXd found = rows->evaluate(records, parameters.data(), {});
    if (!found.allFinite()) return {};
    std::vector<double> result(rows->residuals().size(), nan);
    for (std::size_t k = 0; k < records.size(); ++k) result[records[k]] = found[as_index(k)];
    return result;
  };
}

/// Values row by row.
std::vector<double> lower_triangle(const Eigen::MatrixXd& matrix) {
  return upper_triangle(matrix.transpose());
}

std::vector<WhatIfSums> as_sums(const PartialSums& sums) {
  std::vector<WhatIfSums> result;
  for (std::size_t part = 0; part < sums.counts.size(); ++part)
    result.push_back({lower_triangle(sums.products[part]), sums.counts[part]});
  return result;
}

}  // namespace

WhatIfFit::WhatIfFit(const ModelDefinition& model, const CandidateSet& set, PartitionedColumns flights,
                     PartitionedColumns others, const std::vector<std::size_t>& found, bool is_robust,
                     WhatIfPanel& panel)
    : flights_(std::move(flights)), others_(std::move(others)), groups_(groups_of(set, set.candidates)) {
  base_ = flights_.flights.front().base.cols();
  given_.resize(as_index(panel.coefficients.size()));
  start_.resize(given_.size());
  for (Eigen::Index c = 0; c < given_.size(); ++c) {
    const WhatIfCoefficient& coefficient = panel.coefficients[static_cast<std::size_t>(c)];
    start_[c] = coefficient.start;
    given_[c] = coefficient.given - coefficient.start;
    if (c < base_ && !coefficient.fixed) free_base_.push_back(c);
  }
  for (PartitionedColumns* all : {&flights_, &others_}) {
    for (FlightColumns& flight : all->flights) {
      for (std::size_t i = 0; i < flight.given.size(); ++i)
        flight.given[i] += flight.base.row(as_index(i)).cast<double>().dot(given_.head(base_));
    }
  }
  const auto outside = others_.partition.all_reduce_flights<PartialSums>([&](std::size_t f) {
    const FlightColumns& flight = others_.flights[f];
    PartialSums sums(1, given_.size() + 1);
    for (std::size_t i = 0; i < flight.given.size(); ++i) {
      const Eigen::VectorXd row = row_of(flight, i);
      if (row.allFinite()) sums.add(0, row);
    }
    return sums;
  });
  for (const WhatIfSums& sums : as_sums(outside)) {
    if (sums.samples > 0.0) panel.held_out = sums;
  }
  for (const ColumnGroup& group : groups_) identifiable_.push_back(indices_of(group, base_));
  for (const std::vector<std::size_t>& some : subsets_of(found))
    panel.weights.push_back(find_sums(model, set, some, is_robust));
  panel.unweighted = as_sums(flights_.partition.all_reduce_flights<PartialSums>([&](std::size_t f) {
    const FlightColumns& flight = flights_.flights[f];
    PartialSums sums(held_out_parts + 1, given_.size() + 1);  // the outliers last
    if (flight.reference != 0) return sums;
    std::vector<bool> counts(flight.given.size(), false);
    for (const std::size_t record : binned_.bins[f].records()) counts[record] = true;
    for (std::size_t i = 0; i < flight.given.size(); ++i) {
      if (std::isnan(flight.given[i])) continue;
      const std::size_t part = held_out_part(*flight.samples, flight.samples->time[i]);
      sums.add(counts[i] ? part : held_out_parts, row_of(flight, i));
    }
    return sums;
  }));
  panel.outliers = std::move(panel.unweighted.back());
  panel.unweighted.pop_back();
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    for (const Eigen::Index c : indices_of(groups_[g], base_)) {
      const std::vector<Eigen::Index>& free = identifiable_[g];
      panel.coefficients[static_cast<std::size_t>(c)].fixed = std::count(free.begin(), free.end(), c) == 0;
    }
  }
}

std::vector<Eigen::Index> WhatIfFit::free_columns(const std::vector<std::size_t>& groups) const {
  Indices free = free_base_;
  for (const std::size_t group : groups)
    free.insert(free.end(), identifiable_[group].begin(), identifiable_[group].end());
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

/// Weights of the bins in a refit with these coefficients.
std::vector<Eigen::VectorXd> WhatIfFit::weights_at(const Eigen::VectorXd& values) const {
  const FlightPartition& partition = flights_.partition;
  std::vector<Eigen::VectorXd> weights(binned_.bins.size());
  for (std::size_t first = 0, last = 0; first < weights.size(); first = last) {
    std::vector<Eigen::VectorXd> residuals;
    for (; last < weights.size() && binned_.reference[last] == binned_.reference[first]; ++last) {
      if (partition.is_local(last))
        residuals.emplace_back(binned_.residuals[last] - binned_.columns[last] * values);
    }
    const double deviation = robust_deviation(partition.comm(), residuals);
    for (std::size_t f = first; f < last; ++f)
      weights[f] = weights_of_bins(binned_.bins[f], deviation > 0.0 ? deviation : 1.0);
  }
  return weights;
}

/// Fits the free columns and sets `values`. @param weights of the bins, and later with those of Huber's loss
WhitenedSystem WhatIfFit::least_squares(const Indices& free, bool is_robust, Eigen::VectorXd& values,
                                        std::vector<Eigen::VectorXd>& weights) const {
  constexpr int max_steps = 50;
  constexpr double enough = 1e-3;  // fraction of the uncertainty from the flights
  const std::vector<Eigen::VectorXd> plain = weights;
  WhitenedSystem system;
  system.partition = flights_.partition;
  system.rows.resize(weights.size());
  for (int step = 0; step <= max_steps; ++step) {
    for (std::size_t f = 0; f < weights.size(); ++f) {
      system.rows[f] = weights[f].asDiagonal() * side_by_side(binned_.columns[f], binned_.residuals[f]);
    }
    sum_up(system);
    const Eigen::VectorXd before = values;
    values = solved(system.information, free, values);
    const Eigen::VectorXd length = system.information.diagonal().head(values.size()).cwiseSqrt();
    const bool settled = step > 0 && length.cwiseProduct(values - before).cwiseAbs().maxCoeff() < enough;
    if (!is_robust || settled || step == max_steps) break;
    std::vector<Eigen::VectorXd> residuals;
    for (std::size_t f = 0; f < weights.size(); ++f)
      residuals.emplace_back(plain[f].asDiagonal() * (binned_.residuals[f] - binned_.columns[f] * values));
    const double deviation = std::max(robust_deviation(flights_.partition.comm(), residuals), 1e-300);
    for (std::size_t f = 0; f < weights.size(); ++f)
      weights[f] = plain[f].cwiseProduct((residuals[f] / deviation).unaryExpr(&huber_weight).cwiseSqrt());
  }
  return system;
}

WhatIfWeights WhatIfFit::find_sums(const ModelDefinition& model, const CandidateSet& set,
                                   const std::vector<std::size_t>& found, bool is_robust) {
  const FlightPartition& partition = flights_.partition;
  const std::vector<FlightColumns>& flights = flights_.flights;
  std::vector<ResidualAt> residual_at(flights.size());
  Eigen::VectorXd values = given_;
  std::vector<Eigen::VectorXd> weights;
  WhitenedSystem system;
  // Outliers, and the residual where it is not linear, are those at the coefficients of the round before.
  constexpr int rounds = 3;
  for (int round = 0; round < rounds; ++round) {
    binned_ = in_bins(partition, flights, [&](std::size_t f) {
      if (round == 0) return flights[f].given;
      if (round == 1) residual_at[f] = residual_with(model, set, flights[f], found);
      const std::vector<double> residual = residual_for(flights[f], values, residual_at[f]);
      return is_robust ? calm(flights[f], residual, values) : residual;
    });
    weights = weights_at(values);
    system = least_squares(free_columns(found), is_robust && round > 0, values, weights);
  }
  const Indices free = free_columns(found);
  const std::vector<NoiseModel> noise = noise_of_flights(
      partition, binned_,
      {[&](std::size_t f) -> Eigen::MatrixXd { return binned_.columns[f](Eigen::all, free); },
       [&](std::size_t f) -> Eigen::VectorXd { return binned_.residuals[f] - binned_.columns[f] * values; },
       digest_of(serialized(values))},
      [&](const auto& bins, const auto& fitted, const auto& residuals) {
        return find_noise(bins, fitted, residuals, partition.threads()).model;
      });
  const WhitenedSystem with_noise =
      whiten_system(partition, binned_.bins, binned_.columns, binned_.residuals, noise);
  const EffectSearch search(with_noise, base_, groups_);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    identifiable_[g].clear();
    for (const Eigen::Index column : search.identifiable(g))
      identifiable_[g].push_back(base_ + groups_[g].first + column);
  }
  const auto score_covariance = partition.all_reduce_flights<Eigen::MatrixXd>([&](std::size_t f) {
    const Eigen::MatrixXd scored = weights[f].asDiagonal() * system.rows[f].leftCols(values.size());
    return noise_covariance(scored, binned_.bins[f], noise[f], 0);
  });
  const auto parts = partition.all_reduce_flights<PartialSums>([&](std::size_t f) {
    PartialSums sums(held_out_parts, given_.size() + 1);
    for (std::size_t i = 0; i < binned_.bins[f].size(); ++i)
      sums.add(held_out_part(*flights[f].samples, binned_.bins[f].time()[i]),
               system.rows[f].row(as_index(i)).transpose());
    return sums;
  });
  return {found, as_sums(parts), lower_triangle(score_covariance)};
}

}  // namespace pcor::internal
