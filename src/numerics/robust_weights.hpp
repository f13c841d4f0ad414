#pragma once

#include <algorithm>
#include <cmath>

namespace pcor::internal {

// Losses of residuals in units of their robust deviation. Their widths have 95 % efficiency on normal noise
// (Huber and Ronchetti 2009, Robust Statistics; Holland and Welsch 1977, Communications in Statistics A6,
// 813).

/// From here on Huber's loss is linear.
inline constexpr double huber_width = 1.345;

/// The weight of a residual in a fit with Huber's loss, 0 to 1.
inline double huber_weight(double ratio) { return huber_width / std::max(std::abs(ratio), huber_width); }

/// Beyond this Tukey's loss gives a residual no weight.
inline constexpr double tukey_width = 4.685;

/// The weight of a residual in a fit with Tukey's loss, 0 to 1.
inline double tukey_weight(double ratio) {
  const double square = (ratio / tukey_width) * (ratio / tukey_width);
  return square < 1.0 ? (1.0 - square) * (1.0 - square) : 0.0;
}

/// The derivative of residual times weight by the residual: what it adds to the information.
inline double tukey_slope(double ratio) {
  const double square = (ratio / tukey_width) * (ratio / tukey_width);
  return square < 1.0 ? (1.0 - square) * (1.0 - 5.0 * square) : 0.0;
}

}  // namespace pcor::internal
