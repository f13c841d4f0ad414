#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// What is known of the wanted coefficients before the flights are held against GPS.
struct BeforeGps {
  Eigen::VectorXd values;      ///< of the wanted ones
  Eigen::MatrixXd covariance;  ///< of these, by the other references; empty where there are none
};

/// What GPS makes of the wanted coefficients.
struct GpsFit {
  Eigen::VectorXd values{};
  std::vector<bool> at_bound{};
  Eigen::MatrixXd covariance{};  ///< with what was held
  Eigen::MatrixXd by_noise{};    ///< by the model of the noise alone, without what was held
  Eigen::MatrixXd kept{};        ///< derivatives of the values by those before
  Eigen::VectorXd jackknife{};   ///< standard errors by leaving out parts of the flights
  std::size_t parts = 0;         ///< of five minutes
  double condition_number = 1.0;
  double stated = 0.0;       ///< standard error of delta-p, hPa, rms over the flights
  double held = 0.0;         ///< of it what stands in what was held
  double thermometer = 0.0;  ///< by how much the thermometer is too low, K
  double thermometer_error = 0.0;
  std::vector<std::string> warnings{};  ///< held coefficients, and manoeuvres that determine them
  std::vector<std::string> notes{};
};

/// Whether a reference is one of GPS, wind or height.
bool is_by_gps(const Reference& reference);

/// Fits the wanted coefficients to GPS: maximum a posteriori, with the latent processes of `GpsNoise` and the
/// nuisances of `gps_nuisances`. Without other references each coefficient has a prior about its start, some
/// typical sizes of its effect wide. Directions in which the error of delta-p would be above 1 hPa are held:
/// delta-p stays there as near to that of the start as the rest allows, and the error is that of the prior,
/// or as the file states it.
///
/// The stated covariance is that of the likelihood or that of a jackknife over parts of five minutes; of the
/// two, the one with the larger error of delta-p.
/// @param flights for each reference of GPS the flights of the fit
GpsFit fit_gps(const std::vector<FitFlights*>& flights, const Eigen::VectorXd& start, const BeforeGps& before,
               const std::vector<std::size_t>& wanted);

}  // namespace pcor::internal
