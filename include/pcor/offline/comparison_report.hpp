#pragma once

#include <pcor/offline/compare.hpp>
#include <pcor/offline/refit.hpp>
#include <pcor/offline/report.hpp>

namespace pcor {

/// The report of a comparison: the residuals in time with the regimes shaded, against any variable, over the
/// plane of pressure and Mach number, by regime; delta-p of the reference beside that of the model; and where
/// the models fail most.
Report comparison_report(const Comparison& comparison);

/// The report of a fit: the comparison of the model before and after it, with the coefficients, their errors
/// and correlations, what each effect is worth, and every flight before and after.
/// @param comparison of two models, first the one before and then the one after the fit
Report refit_report(const RefitResult& fit, const Comparison& comparison);

}  // namespace pcor
