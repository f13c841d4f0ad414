#pragma once

#include <string>
#include <vector>

#include "fit/before_and_after.hpp"

namespace pcor::internal {

/// Why the fitted model should not be used, a sentence without full stop: its residuals are larger than with
/// the coefficients of the file by more than 2 % on what was fitted (rms and robust deviation both, since a
/// robust fit may leave outliers more) or by more than 5 % on a part that was held out, or a held-out part is
/// off by more than the fit expects. Empty otherwise.
/// @param bulk_rms_before robust deviation with the coefficients of the file, hPa
std::string why_worse(const RefitResult& result, double bulk_rms_before);

/// Reasons not to trust a fit, one sentence each: residuals vary more than delta-p itself; outliers are
/// consecutive, which indicates a missing effect; outliers are so many that the loss hides a missing effect;
/// or assumed slow drift may be a missing effect.
std::vector<std::string> fit_warnings(const RefitResult& result, const OutlierRun& longest);

/// Warnings if the jackknife contradicts the stated errors, or if stages do not converge.
/// @param with_doubt errors include the uncertainty of a prior or of fixed coefficients
std::vector<std::string> error_notes(const RefitResult& result, std::size_t flights, bool has_converged,
                                     bool with_doubt);

}  // namespace pcor::internal
