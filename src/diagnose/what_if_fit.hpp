#pragma once

#include <Eigen/Dense>
#include <functional>
#include <vector>

#include <pcor/report/report.hpp>
#include "campaign/effect_search.hpp"
#include "campaign/whitened.hpp"
#include "diagnose/flight_columns.hpp"

namespace pcor::internal {

/// The residual of every record of a flight, as computed in a refit, at values of all coefficients; empty if
/// only its derivatives are known.
using ResidualAt = std::function<std::vector<double>(const Eigen::VectorXd& values)>;

/// Fit of a what-if: columns and residual of some flights in units of the noise, weighted as in a refit with
/// the effects that were found, by default all of them. A rank has the columns of its flights; all ranks
/// have the sums.
class WhatIfFit {
 public:
  /// Completes a panel: its sums, with the weights of a refit with some of the effects that were found, and
  /// its unweighted sums. Coefficients of effects that the flights do not determine become fixed.
  /// @param set candidates of the panel, in its order
  /// @param others samples that are not fitted
  /// @param found candidates with which, and with subsets of which, the noise is estimated
  /// @param panel with its coefficients: the residual is linearised at their start values; fixed coefficients
  /// have the given value
  WhatIfFit(const ModelDefinition& model, const CandidateSet& set, PartitionedColumns flights,
            PartitionedColumns others, const std::vector<std::size_t>& found, bool is_robust,
            WhatIfPanel& panel);

  const PartitionedColumns& flights() const { return flights_; }
  const PartitionedColumns& others() const { return others_; }

 private:
  std::vector<Eigen::Index> free_columns(const std::vector<std::size_t>& groups) const;
  WhatIfWeights find_sums(const ModelDefinition& model, const CandidateSet& set,
                          const std::vector<std::size_t>& found, bool is_robust);
  std::vector<double> residual_for(const FlightColumns& flight, const Eigen::VectorXd& values,
                                   const ResidualAt& residual_at) const;
  std::vector<Eigen::VectorXd> weights_at(const Eigen::VectorXd& values) const;
  WhitenedSystem least_squares(const std::vector<Eigen::Index>& free, bool is_robust, Eigen::VectorXd& values,
                               std::vector<Eigen::VectorXd>& weights) const;

  PartitionedColumns flights_;
  PartitionedColumns others_;
  std::vector<ColumnGroup> groups_;
  std::vector<std::vector<Eigen::Index>> identifiable_{};  // columns of each group
  Eigen::Index base_ = 0;
  std::vector<Eigen::Index> free_base_{};  // fitted columns of the model
  Eigen::VectorXd start_{};
  Eigen::VectorXd given_{};  // given values less the start values
  BinnedFlights binned_{};
};

}  // namespace pcor::internal
