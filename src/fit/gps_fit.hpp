#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include <pcor/base/note.hpp>

#include "campaign/gps_rows.hpp"
#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// Prior knowledge of the requested coefficients before the comparison with GPS.
struct BeforeGps {
  Eigen::VectorXd values;            ///< requested coefficients
  Eigen::MatrixXd covariance;        ///< covariance from the other references; empty if there are no others
  std::vector<std::size_t> fixed{};  ///< fixed coefficients with a stated error
  Eigen::MatrixXd carried{};         ///< derivatives of `values` by these; zero if there are no others
};

/// Result of the GPS fit for the requested coefficients.
struct GpsFit {
  Eigen::VectorXd values{};
  std::vector<bool> at_bound{};
  Eigen::MatrixXd covariance{};  ///< includes fixed directions and the errors of fixed coefficients
  Eigen::MatrixXd by_noise{};    ///< noise model and errors of fixed coefficients, without fixed directions
  Eigen::MatrixXd kept{};        ///< derivatives of the values by the previous values
  Eigen::MatrixXd by_fixed{};    ///< derivatives of the values by the fixed coefficients with a stated error
  Eigen::VectorXd jackknife{};   ///< standard errors from omitting parts of the flights
  std::size_t parts = 0;         ///< parts of five minutes
  double condition_number = 1.0;
  double stated = 0.0;                  ///< standard error of delta-p, hPa, rms over the flights
  std::vector<std::string> warnings{};  ///< held coefficients, and manoeuvres that determine them
  Notes notes{};
};

/// Fits the requested coefficients to GPS: maximum a posteriori, with the latent processes of `GpsNoise` and
/// the nuisances of `gps_nuisances`. Without other references each coefficient has a prior about its start,
/// some typical sizes of its effect wide. Directions in which the error of delta-p would be above 1 hPa are
/// held: delta-p stays there as near to that of the start as the rest allows, and the error is that of the
/// prior, or as the file states it.
///
/// The stated covariance is that of the likelihood or that of a jackknife over parts of five minutes, the one
/// with the larger error of delta-p.
///
/// Errors of fixed coefficients with a stated error are not corrected: the fit takes their values as exact.
/// With rows X by the requested coefficients and the nuisances, H by the fixed ones, their weight W and the
/// posterior covariance P, the result changes by K `carried` - P X'WH, where K = 1 - P X'WX is `kept`. The
/// stated covariance has this part in addition, and the prior is `covariance` without the same part. Errors
/// of the law of a reference stay in the prior: GPS does not depend on them, and so corrects them.
/// @param flights for each reference of GPS the flights of the fit
GpsFit fit_gps(const std::vector<FitFlights*>& flights, const Eigen::VectorXd& start, const BeforeGps& before,
               const std::vector<std::size_t>& requested);

}  // namespace pcor::internal
