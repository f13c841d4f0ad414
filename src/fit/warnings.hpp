#pragma once

#include <string>
#include <vector>

#include "fit/before_and_after.hpp"

namespace pcor::internal {

/// Reason not to use the fitted model, a sentence without full stop: its residuals exceed those with the
/// input model by more than 2 % on fitted samples (both rms and robust deviation, since a robust
/// fit may increase outliers) or by more than 5 % on a held-out part, or the bias of a held-out part exceeds
/// the expectation of the fit, or by GPS the standard error of delta-p exceeds 10 hPa. Empty otherwise.
/// @param bulk_rms_before robust deviation with the input model, hPa
std::string why_worse(const RefitResult& result, double bulk_rms_before);

/// Reasons not to trust a fit, one sentence each: residuals vary more than delta-p itself; outliers are
/// consecutive, which indicates a missing effect; too many outliers, so that the loss may hide a missing
/// effect; or the rms residual is more than 2 % above that of plain least squares.
std::vector<std::string> fit_warnings(const RefitResult& result, const OutlierRun& longest);

/// Warnings if the jackknife contradicts the stated errors, or if stages do not converge.
/// @param with_uncertainty errors include the uncertainty of a prior or of fixed coefficients
std::vector<std::string> error_notes(const RefitResult& result, std::size_t flights, bool has_converged,
                                     bool with_uncertainty);

}  // namespace pcor::internal
