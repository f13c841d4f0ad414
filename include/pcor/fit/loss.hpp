#pragma once

#include <optional>
#include <string_view>

namespace pcor {

/// Loss functions of residuals in units of the noise. All except `none` reduce the weight of outliers.
enum class Loss {
  tukey,  ///< Tukey's bisquare: zero weight beyond 4.685 robust standard deviations
  /// Default: linear beyond 4 robust standard deviations. The misfit of a model is larger than its noise and
  /// not an outlier, so a narrower loss would favour some regimes.
  huber,
  soft_l1,  ///< soft_l1 of scipy: 2 (sqrt(1 + s) - 1), s in squared robust standard deviations
  cauchy,   ///< log(1 + s), s in squared units of 2.385 robust standard deviations
  none      ///< least squares
};

std::string_view to_string(Loss loss);

/// Loss with the given name; nullopt if unknown.
std::optional<Loss> loss_named(std::string_view name);

}  // namespace pcor
