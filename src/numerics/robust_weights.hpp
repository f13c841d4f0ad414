#pragma once

#include <algorithm>
#include <cmath>

namespace pcor::internal {

// Losses of residuals in units of their robust deviation (Huber and Ronchetti 2009, Robust Statistics).

/// Residual, in standard deviations, above which Huber's loss is linear: wide, because errors of a model are
/// not outliers, and its coefficients must be the least-squares values over all samples.
inline constexpr double huber_width = 4.0;

/// The weight of a residual in a fit with Huber's loss, 0 to 1.
inline double huber_weight(double ratio) { return huber_width / std::max(std::abs(ratio), huber_width); }

/// Beyond this Tukey's loss gives a residual no weight: 95 % efficiency on normal noise (Holland and Welsch
/// 1977, Communications in Statistics A6, 813).
inline constexpr double tukey_width = 4.685;

}  // namespace pcor::internal
