#pragma once

#include <string>
#include <vector>

#include <pcor/base/note.hpp>
#include "fit/fit_covariance.hpp"

namespace pcor::internal {

/// Result of the GPS fit, in addition to coefficients and covariance.
struct GpsFit {
  double condition_number = 1.0;
  double stated = 0.0;                  ///< standard error of delta-p, hPa, rms over the flights
  std::vector<std::string> warnings{};  ///< held coefficients, and manoeuvres that determine them
  Notes notes{};
};

/// Fits the requested coefficients to GPS: maximum a posteriori, with the latent processes of `GpsNoise` and
/// the nuisances of `gps_nuisances`. Without other references each coefficient has a prior about its start, a
/// few typical sizes of its effect wide. Directions in which the error of delta-p would be above 1 hPa are
/// fixed: delta-p stays as near to that of the input model as the rest allows, with the error of the prior or
/// the error stated in the file.
///
/// The stated covariance is, along each common principal axis, the larger of that of the likelihood and that
/// of a jackknife over parts of five minutes.
///
/// Errors of fixed coefficients with a stated error are not corrected: the fit takes their values as exact.
/// With rows X by the requested coefficients and the nuisances, H by the fixed ones, their weight W and the
/// posterior covariance P, the result changes by K C - P X'WH, where K = 1 - P X'WX, and C are the
/// derivatives of the values before the fit. The stated covariance has this part in addition, and the prior
/// is the covariance before without the same part. Errors of the law of a reference stay in the prior: GPS
/// does not depend on them, and so corrects them.
/// @param flights for each reference of GPS the flights of the fit
/// @param solution in: the start, or the result of the other references; out: values and bounds
/// @param covariance in: covariance by the other references; empty if there are no other references. Out: all
/// but `uncertainties`; the jackknife omits parts of five minutes; `by_noise` excludes held directions by GPS
/// alone, and is the stated covariance after other references
GpsFit fit_gps(const std::vector<FitFlights*>& flights, Solution& solution, FitCovariance& covariance);

}  // namespace pcor::internal
