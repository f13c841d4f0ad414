#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pcor::internal {

/// Turbulence comes and goes, so the level of the noise is found for each five minutes on its own, s.
inline constexpr double local_noise_time = 300.0;

/// The samples of these five minutes, one at least. @param step s
inline std::size_t local_noise_samples(double step) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(local_noise_time / step));
}

/// Noise level of the five minutes with the measured level `here`, shrunk by 15 % (of its logarithm) towards
/// the level of the whole series; the level of the whole series if `here` is NaN.
inline double local_noise_level(double here, double whole) {
  constexpr double own_share = 0.85;
  if (!(here > 0.0)) here = whole;
  return std::exp(own_share * std::log(here) + (1.0 - own_share) * std::log(whole));
}

}  // namespace pcor::internal
