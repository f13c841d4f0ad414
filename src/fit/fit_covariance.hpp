#pragma once

#include <Eigen/Dense>
#include <memory>
#include <string>
#include <vector>

#include "fit/fit_flights.hpp"
#include "fit/misfit.hpp"

namespace pcor::internal {

/// Equations of a fit: some of the requested parameters from the samples of some flights.
struct FitEquations {
  std::shared_ptr<FitFlights> flights;
  std::vector<std::size_t> parameters;
};

struct FitCovariance {
  /// Covariance of the parameters of all equations, in their order, followed by fixed parameters with an
  /// error stated in the files. Zero for parameters at a bound.
  Eigen::MatrixXd matrix{};
  /// Covariance of the equations' parameters from noise and errors of fixed coefficients, without the misfit
  /// of the law.
  Eigen::MatrixXd by_noise{};
  /// Covariance that includes the misfit of the law, without the uncertainty of the reference and of fixed
  /// coefficients, which are the same on all flights.
  Eigen::MatrixXd by_flights{};
  /// Names of the reference uncertainties, and the change of the equations' parameters by one standard
  /// uncertainty of each.
  std::vector<std::string> uncertainties{};
  Eigen::MatrixXd by_uncertainty{};
  /// Jackknife standard errors of the equations' parameters, omitting one flight or one part of a flight at a
  /// time; independent of the noise model. Infinite if one of these alone determines the parameter, NaN with
  /// fewer than three of them or at a bound.
  Eigen::VectorXd jackknife{};
  std::size_t blocks = 0;    ///< omitted flights, or parts of flights
  double information = 0.0;  ///< information of all bins about a common mean, 1/hPa^2
};

/// Covariance of the fitted parameters of one or several stages.
///
/// The equations of all stages form one system: the derivatives by the parameters are orthogonal to the
/// residual. The derivatives of all equations by all parameters are A, the covariance of their scores is B,
/// and the covariance of the parameters is A^-1 B A^-T (Newey and McFadden 1994, Handbook of Econometrics 4,
/// section 6). A score is the sum of weighted derivative times influence (rho' r). Its covariance comes from
/// the noise (`noise_covariance`), which references of a static pressure share by the correlation of their
/// residuals less misfit, and the misfit of the law. Errors of fixed parameters propagate to the others.
///
/// @param equations in the order of the requested parameters; the last ones include all samples
FitCovariance fit_covariance(const std::vector<FitEquations>& equations, const Solution& solution,
                             const Misfit& misfit);

}  // namespace pcor::internal
