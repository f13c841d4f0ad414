#pragma once

#include <pcor/compare/compare.hpp>
#include <pcor/fit/refit.hpp>
#include <pcor/report/report.hpp>

namespace pcor {

/// The report of a fit: the comparison of the model before and after it, with the coefficients, their errors
/// and correlations, what each effect is worth, and every flight before and after.
/// @param comparison of two models, first the one before and then the one after the fit
Report refit_report(const RefitResult& fit, const Comparison& comparison);

}  // namespace pcor
