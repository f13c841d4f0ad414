#pragma once

#include <Eigen/Dense>
#include <cstddef>

#include "numerics/binning.hpp"
#include "numerics/noise_model.hpp"

namespace pcor::internal {

/// Covariance matrix of sums over the bins of a flight, U' C U, with the covariance C of the noise: the
/// autoregression at the level of each bin, within stretches, and the drift components, which continue over
/// gaps. O(bins x columns^2).
///
/// @param columns U, one row for each bin
/// @param flight the number of the flight among the levels of the noise
Eigen::MatrixXd noise_covariance(const Eigen::MatrixXd& columns, const Binning& bins, const NoiseModel& noise,
                                 std::size_t flight);

}  // namespace pcor::internal
