#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace pcor::internal {

/// Correction to deliver if one of several rivals is the cause.
struct RivalChoice {
  std::optional<std::size_t> rival{};  ///< index; empty if no rival is applied
  double error = 0.0;                  ///< expected, rms over samples and rivals, hPa
  double error_of_first = 0.0;         ///< the same if the first rival is applied
};

/// Chooses the rival of the least expected squared error of the static pressure,
///   sum over k of weight_k <(change_i - change_k)^2>,
/// among those that are harmful under no rival: under any rival, the corrected static pressure may be worse
/// than the uncorrected one by at most `tolerance`. No correction is also a choice. Where the expected error
/// of the first rival is within the tolerance, it stays. Coefficients of different models are never averaged:
/// a coefficient of one effect may multiply that of another.
///
/// @param changes change of the static pressure by each rival, hPa, on the same samples, NaN if missing
/// @param weights probabilities of the rivals, which add up to 1 @param tolerance rms, hPa
RivalChoice choose_rival(const std::vector<std::vector<double>>& changes, const std::vector<double>& weights,
                         double tolerance);

}  // namespace pcor::internal
