#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <functional>
#include <vector>

#include <pcor/report/report.hpp>
#include "campaign/binned_flights.hpp"
#include "diagnose/flight_columns.hpp"
#include "diagnose/flown_regimes.hpp"
#include "diagnose/search.hpp"
#include "numerics/noise_model.hpp"

namespace pcor::internal {

/// The residual of every record of a flight, as computed in a refit, at values of all coefficients; empty if
/// only its derivatives are known.
using ResidualAt = std::function<std::vector<double>(const Eigen::VectorXd& values)>;

/// Residual function of a flight with some groups in the model; empty if only its derivatives are known.
using ResidualWith =
    std::function<ResidualAt(const FlightColumns& flight, const std::vector<std::size_t>& groups)>;

/// Products of (columns, residual) with themselves, summed over `count` samples.
struct SumOfProducts {
  Eigen::MatrixXd products{};
  double count = 0.0;

  SumOfProducts& operator+=(const SumOfProducts& other);

  template <class Archive>
  void serialize(Archive& archive) {
    archive(products, count);
  }
};

/// Least-squares problem of a what-if: columns and residual of some flights in units of the noise, with the
/// weights of a refit with all effects that were found, unless stated otherwise. A process of a team has the
/// columns of its flights only; every process has the sums.
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
  struct Weights {
    std::vector<std::size_t> found;
    std::vector<SumOfProducts> parts;
    Eigen::MatrixXd
        score_covariance;  ///< covariance of the products of columns and residual due to the noise
  };

  /// The first element is without findings, the last with all findings.
  const std::vector<Weights>& weights() const { return weights_; }
  const std::vector<SumOfProducts>& alike() const { return alike_; }
  const SumOfProducts& outliers() const { return outliers_; }
  const SumOfProducts& held_out() const { return held_out_; }

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
  void settle(const std::vector<std::size_t>& found, bool is_robust, const ResidualWith& residual_with);
  /// Gives the coefficients with the groups that were found.
  /// @param residual_of gives the residual of an own flight with these
  void find_sums(const std::vector<std::size_t>& found, bool is_robust,
                 const std::function<const ResidualAt&(std::size_t flight)>& residual_of);
  std::vector<double> residual_for(const FlightColumns& flight, const Eigen::VectorXd& values,
                                   const ResidualAt& residual_at) const;
  Eigen::MatrixXd score_covariance(std::size_t flight, const Eigen::MatrixXd& rows,
                                   const NoiseModel& noise) const;
  std::vector<NoiseModel> weights_after(const Eigen::VectorXd& values, std::vector<NoiseModel> noise) const;
  std::vector<NoiseModel> noise_after(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& free,
                                      bool drifts) const;
  void sum_records();
  void sum_held_out();

  TeamColumns flights_;
  TeamColumns others_;
  std::vector<ColumnGroup> groups_;
  std::vector<std::vector<Eigen::Index>> told_{};  // columns of each group
  Eigen::Index base_ = 0;
  std::vector<Eigen::Index> own_{};
  Eigen::VectorXd start_{};
  Eigen::VectorXd given_{};  // given values less the start values
  BinnedFlights binned_{};
  std::vector<FlownRegime> regimes_{};
  std::vector<Weights> weights_{};
  SumOfProducts whole_{};       // with the weights of a refit
  SumOfProducts with_noise_{};  // divided by the noise, without its autocorrelation
  std::vector<SumOfProducts> alike_{};
  SumOfProducts outliers_{};
  SumOfProducts held_out_{};
};

}  // namespace pcor::internal
