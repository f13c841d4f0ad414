#pragma once

#include <string>
#include <vector>

#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// Why the fitted model should not be used, a sentence without full stop: its residuals are larger than with
/// the coefficients of the file by more than 2 % on what was fitted (rms and robust deviation both, since a
/// robust fit may leave outliers more) or by more than 5 % on a part that was held out, or a held-out part is
/// off by more than the fit expects. Empty otherwise.
/// @param bulk_rms_before robust deviation with the coefficients of the file, hPa
std::string why_worse(const RefitResult& result, double bulk_rms_before);

/// Why a fit should not be trusted, a sentence each: its residuals vary more than delta-p itself; samples
/// that count as outliers come in a row, which outliers do not; outliers are so many that the loss hides what
/// the model lacks; or what was taken for slow drift may be what the model lacks.
std::vector<std::string> fit_warnings(FitFlights& flights, const RefitResult& result,
                                      const Eigen::VectorXd& values);

/// In words: where the jackknife does not bear out the stated errors, and stages that do not come to rest.
/// @param with_doubt errors hold that of a prior, or of coefficients that were held
std::vector<std::string> error_notes(const RefitResult& result, std::size_t flights, bool has_converged,
                                     bool with_doubt);

}  // namespace pcor::internal
