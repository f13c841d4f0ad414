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

inline std::string_view to_string(Loss loss) { return loss == Loss::huber ? "huber" : "none"; }

/// Loss with the given name; nullopt if unknown.
inline std::optional<Loss> loss_named(std::string_view name) {
  for (const Loss loss : {Loss::huber, Loss::none}) {
    if (name == to_string(loss)) return loss;
  }
  return std::nullopt;
}

}  // namespace pcor
