#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace pcor::internal {

/// The correction that is delivered where one of several rivals is the cause.
struct RivalChoice {
  std::optional<std::size_t> rival{};  ///< its number; nothing: no rival is applied
  double error = 0.0;                  ///< expected, rms over samples and rivals, hPa
};

/// Chooses the rival of the least expected squared error of the static pressure,
///   sum over k of weight_k <(change_i - change_k)^2>,
/// among those that no rival calls a harm: the corrected static pressure may not be further from where any
/// rival has it than without a correction, but for `tolerance`. No correction is a choice, too.
/// Where the expected error of the first rival is within the tolerance, it stays. Coefficients of
/// different models are never averaged: a coefficient of one effect may multiply that of another.
///
/// @param changes by how much each rival changes the static pressure, hPa, of the same samples, NaN where
/// missing @param weights probabilities of the rivals, which add up to 1 @param tolerance rms, hPa
RivalChoice choose_rival(const std::vector<std::vector<double>>& changes, const std::vector<double>& weights,
                         double tolerance);

}  // namespace pcor::internal
