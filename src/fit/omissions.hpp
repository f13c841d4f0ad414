#pragma once

#include "fit/before_and_after.hpp"

namespace pcor::internal {

/// Sum of the squared residuals of a fit at any coefficients, hPa^2, from one triangular factor if the
/// residual is linear in all fitted parameters.
class SquaredResiduals {
 public:
  SquaredResiduals(FitFlights& flights, const Solution& solution);

  bool is_linear() const { return is_linear_; }
  double at(const Eigen::VectorXd& values) const;
  /// Minimum over all coefficients; NaN if the residual is not linear, or if two systems are fitted, because
  /// their derivatives contain the noise of the residual.
  double minimum() const;

 private:
  FitFlights& flights_;
  const Solution& solution_;
  bool is_linear_;
  Eigen::MatrixXd factor_;
};

/// Fit without each effect: its parameters are set to their neutral values and the others are refitted with
/// unchanged sample weights.
std::vector<Omission> omissions(FitFlights& flights, const Solution& solution, const FitSums& sums,
                                const SquaredResiduals& squares);

}  // namespace pcor::internal
