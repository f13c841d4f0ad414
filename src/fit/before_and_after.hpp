#pragma once

#include <string>
#include <vector>

#include <pcor/regimes/regimes.hpp>
#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// The flights with the coefficients of the files and with those of the fit.
struct BeforeAndAfter {
  std::vector<FlightFit> flights{};  ///< the parts that were fitted and those that were held out
  std::vector<FlightFit> further{};  ///< results with each further reference
  std::vector<std::string> notes{};  ///< about fitted flights
  RegimeSet flown{};                 ///< regimes in the fitted flights
  Statistics flaps_out{};            ///< fitted flights

  /// Unit hPa, over all fitted samples.
  double noise_rms(std::size_t samples) const;
};

/// @param covariance of the fitted parameters, without the uncertainty of the reference, which is common to
/// the held-out samples
/// @param left misfit of the law, hPa, rms
BeforeAndAfter before_and_after(FitFlights& flights, const Eigen::VectorXd& values,
                                const Eigen::MatrixXd& covariance, double left);

}  // namespace pcor::internal
