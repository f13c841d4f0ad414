#pragma once

#include "fit/fit_sums.hpp"

namespace pcor::internal {

/// The sum of the squared residuals of a fit at any coefficients, hPa^2: where the residual is linear in all
/// that is fitted, from one triangular factor.
class SquaredResiduals {
 public:
  SquaredResiduals(FitFlights& flights, const Solution& solution);

  bool is_linear() const { return is_linear_; }
  double at(const Eigen::VectorXd& values) const;
  /// The least that any coefficients leave; NaN where the residual is not linear, or
  /// two systems are fitted, whose derivatives hold the noise of the residual.
  double least() const;

 private:
  FitFlights& flights_;
  const Solution& solution_;
  bool is_linear_;
  Eigen::MatrixXd factor_;
};

/// What the fit becomes without each effect: its parameters go to their neutral values and the others follow,
/// with the weights that the samples have.
std::vector<Omission> omissions(FitFlights& flights, const Solution& solution, const FitSums& sums,
                                const SquaredResiduals& squares);

}  // namespace pcor::internal
