#pragma once

namespace pcor::internal {

/// Beyond so many robust deviations Tukey's loss gives a sample no weight: 95 % efficiency on normal noise
/// (Holland and Welsch 1977, Communications in Statistics A6, 813).
inline constexpr double tukey_width = 4.685;

/// The weight that Tukey's loss gives to a residual in a fit, 0 to 1.
/// @param ratio of the residual to the robust deviation of all
inline double tukey_weight(double ratio) {
  const double part = ratio / tukey_width;
  const double inside = 1.0 - part * part;
  return inside > 0.0 ? inside * inside : 0.0;
}

/// The derivative by that ratio of ratio and weight together: what a residual adds to the information.
inline double tukey_slope(double ratio) {
  const double square = (ratio / tukey_width) * (ratio / tukey_width);
  return square < 1.0 ? (1.0 - square) * (1.0 - 5.0 * square) : 0.0;
}

}  // namespace pcor::internal
