#pragma once

#include <pcor/numerics/noise.hpp>

#include <cstddef>
#include <vector>

namespace pcor {

/// What residuals, hPa, amount to over some samples. NaN where there are too few samples.
struct Statistics {
  std::size_t samples = 0;
  double bias = 0.0;        ///< mean residual, hPa
  double bias_error = 0.0;  ///< its standard error, hPa, for the memory of the noise
  double rms = 0.0;         ///< about zero, hPa
  double noise_rms = 0.0;   ///< of the noise floor over the same samples, hPa: the lowest of all models

  /// The scatter about the bias, hPa.
  double scatter() const;
  /// By how much the rms is larger than the noise alone would make it; NaN where the noise is not known.
  double rms_over_noise() const;
};

/// Whether a model fails more in `a` than in `b`: by how much the mean square is above that of the noise.
/// Where the noise is not known nothing is said to fail.
bool fails_more(const Statistics& a, const Statistics& b);

/// Statistics of the residuals of one series at the samples where `used` is true.
/// @param noise the noise floor of the series
Statistics statistics_of(const std::vector<double>& residuals, const NoiseFloor& noise,
                         const std::vector<bool>& used);

}  // namespace pcor
