#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <vector>

#include "numerics/binning.hpp"
#include "numerics/noise_model.hpp"

namespace pcor::internal {

/// Sum over all pairs of samples of u(t) C(t-s) v(s), for columns u, v and the autocovariance C of the
/// process: the covariance matrix of the sums (column . noise).
///
/// @param columns one row for each sample, zero for missing samples
/// @param segments the parts of the series without a gap in time
Eigen::MatrixXd covariance_of_sums(const Autoregression& noise, const Eigen::MatrixXd& columns,
                                   const std::vector<Segment>& segments);

/// Covariance matrix of sums over the bins of a flight, U' C U, with the covariance C of the noise: the
/// autoregression at the level of each bin, within stretches, and the drift components, which continue over
/// gaps. O(bins x columns^2).
///
/// @param columns U, one row for each bin
/// @param flight the number of the flight among the levels of the noise
Eigen::MatrixXd noise_covariance(const Eigen::MatrixXd& columns, const Binning& bins, const NoiseModel& noise,
                                 std::size_t flight);

}  // namespace pcor::internal
