#pragma once

#include <Eigen/Dense>
#include <memory>
#include <string>
#include <vector>

#include "fit/fit_flights.hpp"
#include "fit/misfit.hpp"

namespace pcor::internal {

/// The equations that a fit solves: some parameters from the samples of some flights, with what their stage
/// found.
struct FitEquations {
  FitFlights* flights;
  std::vector<std::size_t> parameters;
  Solution solution;
};

struct FitCovariance {
  /// Of the parameters of all equations, in their order, and after them of those that were held at a value of
  /// which the files state the error. Zero for those at a bound.
  Eigen::MatrixXd matrix{};
  /// Of the parameters of the equations by the noise and what held coefficients may err by, without the
  /// misfit of the law.
  Eigen::MatrixXd by_noise{};
  /// The same with the misfit of the law: all but the doubt of the reference.
  Eigen::MatrixXd by_flights{};
  /// Names of the doubts of the references, and by how much one standard uncertainty of each changes the
  /// parameters of the equations.
  std::vector<std::string> doubts{};
  Eigen::MatrixXd by_doubt{};
  /// The standard errors of the parameters of the equations by leaving out one flight, or one part of a
  /// flight, after another: they need no model of the noise.
  Eigen::VectorXd jackknife{};
  std::size_t blocks = 0;    ///< flights, or parts of flights, that were left out
  double information = 0.0;  ///< that all bins have of a common mean, 1/hPa^2
};

/// The covariance of what a fit, of one or several stages, makes of the noise.
///
/// The equations of all stages stand in one system: each says that the derivatives by its parameters are at
/// right angles to what is left. Their derivatives by all parameters are A, the covariance of their scores is
/// B, and that of the parameters A^-1 B A^-T (Newey and McFadden 1994, Handbook of Econometrics 4, section
/// 6). A score is the sum of weighted derivative times influence (rho' r). Its covariance is that
/// of the noise (`noise_covariance`) and of the misfit of the law; for references of many samples that of an
/// autoregression of the influence. What parameters that are held may err by goes on to the others.
///
/// @param misfit of the law, with its columns
/// @param equations the last of them of all samples @param held parameters that were not fitted and of which
///        the files state an error
FitCovariance fit_covariance(const std::vector<FitEquations>& equations, const std::vector<std::size_t>& held,
                             const Misfit& misfit, const MisfitBasis& misfit_columns);

}  // namespace pcor::internal
