#pragma once

#include <pcor/compare/compare.hpp>
#include <pcor/report/report.hpp>

namespace pcor {

/// The report of a comparison: the residuals in time with the regimes shaded, against any variable, over the
/// plane of pressure and Mach number, by regime; delta-p of the reference beside that of the model; and where
/// the models fail most.
Report comparison_report(const Comparison& comparison);

}  // namespace pcor
