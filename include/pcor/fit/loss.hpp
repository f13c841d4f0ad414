#pragma once

#include <optional>
#include <string_view>

namespace pcor {

/// How residuals count in a fit, by their size in units of the noise. All but `none` let outliers count less.
enum class Loss {
  tukey,  ///< Tukey's bisquare: beyond 4.685 robust deviations a residual does not count at all
  /// The default: linear beyond 4 robust deviations. What a law lacks is larger than its noise and no
  /// outlier, so a narrow loss would take the side of some regimes.
  huber,
  soft_l1,  ///< as scipy's soft_l1: 2 (sqrt(1 + s) - 1), s in squared robust deviations
  cauchy,   ///< log(1 + s), s in squared units of 2.385 robust deviations
  none      ///< least squares
};

std::string_view to_string(Loss loss);

/// The loss of that name; nothing where there is none.
std::optional<Loss> loss_named(std::string_view name);

}  // namespace pcor
