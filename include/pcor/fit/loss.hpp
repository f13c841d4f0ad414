#pragma once

#include <optional>
#include <string_view>

namespace pcor {

/// How residuals count in a fit, by their size in units of the noise. All but `none` let outliers count less.
enum class Loss {
  /// Tukey's bisquare, beyond 4.685 robust deviations nothing. The default: on clean normal noise its errors
  /// are 5 % larger than those of least squares, and outliers of whatever size move nothing, whereas the
  /// bounded influence of Huber's loss moves a coefficient by several standard errors once a few per cent
  /// of some thousand samples lie on one side. It starts from Huber's solution, which is unique.
  tukey,
  huber,    ///< linear beyond 1.345 robust deviations
  soft_l1,  ///< as scipy's soft_l1: 2 (sqrt(1 + s) - 1), s in squared robust deviations
  cauchy,   ///< log(1 + s), s in squared units of 2.385 robust deviations
  none      ///< least squares
};

std::string_view name_of(Loss loss);

/// The loss of that name; nothing where there is none.
std::optional<Loss> loss_named(std::string_view name);

}  // namespace pcor
