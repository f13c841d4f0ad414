#pragma once

#include <optional>
#include <string_view>

namespace pcor {

/// Loss function of residuals in units of the noise. Both have one minimum.
enum class Loss {
  /// Default: linear beyond 4 robust standard deviations, so that outliers have less weight. The misfit of a
  /// model is larger than its noise and not an outlier, so a narrower loss would favour some regimes.
  huber,
  none  ///< least squares
};

std::string_view to_string(Loss loss);

/// Loss with the given name; nullopt if unknown.
std::optional<Loss> loss_named(std::string_view name);

}  // namespace pcor
