#pragma once

#include <string>
#include <vector>

#include <pcor/regimes/regimes.hpp>
#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// The flights with the coefficients of the files and with those of the fit.
struct BeforeAndAfter {
  std::vector<FlightFit> flights{};  ///< the parts that were fitted and those that were held out
  std::vector<FlightFit> further{};  ///< the same with each further reference
  std::vector<std::string> notes{};  ///< of flights that took part
  RegimeSet flown{};                 ///< in flights that took part
  Statistics flaps_out{};            ///< of flights that took part

  /// Over all samples that were fitted, hPa.
  double noise_rms(std::size_t samples) const;
};

/// @param covariance of the fitted parameters, without the doubt of the reference: that is the same in what
///        was held out
/// @param left what the law lacks, hPa, rms
BeforeAndAfter before_and_after(FitFlights& flights, const Eigen::VectorXd& values,
                                const Eigen::MatrixXd& covariance, double left);

}  // namespace pcor::internal
