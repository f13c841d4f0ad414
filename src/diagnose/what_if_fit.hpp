#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <functional>
#include <vector>

#include <pcor/report/report.hpp>
#include "campaign/whitened.hpp"
#include "diagnose/flight_columns.hpp"
#include "diagnose/flown_regimes.hpp"
#include "diagnose/search.hpp"

namespace pcor::internal {

/// The residual of every record of a flight, as computed in a refit, at values of all coefficients; empty if
/// only its derivatives are known.
using ResidualAt = std::function<std::vector<double>(const Eigen::VectorXd& values)>;

/// Residual function of a flight with some groups in the model; empty if only its derivatives are known.
using ResidualWith =
    std::function<ResidualAt(const FlightColumns& flight, const std::vector<std::size_t>& groups)>;

/// Fit of a what-if: columns and residual of some flights in units of the noise, weighted as in a refit with
/// the effects that were found, by default all of them. A member of a team has the columns of its flights;
/// all members have the sums.
class WhatIfFit {
 public:
  /// @param others samples that are not fitted
  /// @param coefficients of all columns: the residual is linearised at their start values; fixed coefficients
  /// have the given value
  /// @param found groups with which, and with subsets of which, the noise is estimated
  WhatIfFit(TeamColumns flights, TeamColumns others, const std::vector<WhatIfCoefficient>& coefficients,
            std::vector<ColumnGroup> groups, const std::vector<std::size_t>& found, bool is_robust,
            const ResidualWith& residual_with);

  const TeamColumns& flights() const { return flights_; }
  const TeamColumns& others() const { return others_; }
  const std::vector<ColumnGroup>& groups() const { return groups_; }
  Eigen::Index base() const { return base_; }
  /// The model's own columns that are fitted.
  const std::vector<Eigen::Index>& own() const { return own_; }
  /// The regimes of the flights.
  const std::vector<FlownRegime>& regimes() const { return regimes_; }

  /// Sums over the parts of the flights with the weights of a refit with some of the effects that were found.
  /// The first element is without findings, the last with all findings.
  const std::vector<WhatIfWeights>& weights() const { return weights_; }
  /// Unweighted sums of the records of the first reference in the same parts, followed by the outliers.
  const std::vector<WhatIfSums>& alike() const { return alike_; }
  /// Unweighted sums of the records outside the fit; empty without such records.
  const std::vector<WhatIfSums>& held_out() const { return held_out_; }

  /// Information matrix of all columns.
  Eigen::MatrixXd information() const;

  /// Changes of all coefficients from the start, and their standard errors.
  struct Fitted {
    Eigen::VectorXd values;
    Eigen::VectorXd errors;
  };

  /// Fits the model's own coefficients with those of some groups; the other coefficients keep the given
  /// values.
  Fitted fitted(const std::vector<std::size_t>& groups) const;

  /// Variance of one row of the whitened residuals after this fit.
  double variance(const std::vector<std::size_t>& groups) const;

  /// Marks coefficients that the flights do not determine, and sets the scale of the changes of each.
  void describe(std::vector<WhatIfCoefficient>& coefficients) const;

 private:
  std::vector<Eigen::Index> free_columns(const std::vector<std::size_t>& groups) const;
  void find_sums(const std::vector<std::size_t>& found, bool is_robust, const ResidualWith& residual_with);
  std::vector<double> residual_for(const FlightColumns& flight, const Eigen::VectorXd& values,
                                   const ResidualAt& residual_at) const;
  std::vector<Eigen::VectorXd> weights_at(const Eigen::VectorXd& values) const;
  WhitenedSystem least_squares(const std::vector<Eigen::Index>& free, bool is_robust, Eigen::VectorXd& values,
                               std::vector<Eigen::VectorXd>& weights) const;

  TeamColumns flights_;
  TeamColumns others_;
  std::vector<ColumnGroup> groups_;
  std::vector<std::vector<Eigen::Index>> identifiable_{};  // columns of each group
  Eigen::Index base_ = 0;
  std::vector<Eigen::Index> own_{};
  Eigen::VectorXd start_{};
  Eigen::VectorXd given_{};  // given values less the start values
  BinnedFlights binned_{};
  std::vector<FlownRegime> regimes_{};
  std::vector<WhatIfWeights> weights_{};
  // Products of (columns, residual): as a refit weighs the rows, and in units of the noise without its memory
  Eigen::MatrixXd least_squares_{};
  Eigen::MatrixXd information_{};
  double row_count_ = 0.0;
  std::vector<WhatIfSums> alike_{};
  std::vector<WhatIfSums> held_out_{};
};

}  // namespace pcor::internal
