#pragma once

#include <Eigen/Dense>
#include <vector>

#include "diagnose/binning.hpp"

namespace pcor::internal {

/// The noise of a series of binned residuals: an autoregression whose level changes every five minutes, and
/// beside it a slow drift, a random walk.
struct NoiseModel {
  std::vector<double> coefficients{};    ///< of the autoregression, from bin to bin
  std::vector<Eigen::VectorXd> level{};  ///< of each flight's bins: rms of the innovations, hPa
  double drift = 0.0;  ///< the drift is drift * sum over k of z_k cos(pi k t/T)/k, z_k normal, hPa
};

/// Estimates autoregression and level from residuals that hold no effect any more. Slow drift is taken off
/// before, so that it does not pass for memory of the noise.
///
/// @param residuals of each flight, in bins, hPa
NoiseModel estimate_noise(const std::vector<Binning>& bins, const std::vector<Eigen::VectorXd>& residuals);

/// The columns in units of the noise and without its memory: each row is scaled by the level and what the
/// rows before predict is taken off; exact at the beginning of stretches.
Eigen::MatrixXd whitened(const Eigen::Ref<const Eigen::MatrixXd>& columns, const Binning& bins,
                         const NoiseModel& noise, std::size_t flight);

/// The shapes of slow drift over a flight, cos(pi k t/T)/k: periods down to five minutes, at most 48.
Eigen::MatrixXd drift_shapes(const Binning& bins);

}  // namespace pcor::internal
