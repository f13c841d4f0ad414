#pragma once

#include <pcor/compare/compare.hpp>
#include <pcor/report/report.hpp>

namespace pcor {

/// Report of a comparison: residuals in time with the regimes shaded, against any variable, over the plane of
/// pressure and Mach number, and by regime; delta-p of the reference and of the model; time ranges with the
/// largest residuals.
Report comparison_report(const Comparison& comparison);

}  // namespace pcor
