#pragma once

#include <vector>

#include <pcor/inspect/inspect.hpp>
#include <pcor/report/report.hpp>

namespace pcor {

/// Page of `pcor inspect`: track, height, speed and regimes of the flights, and tables of roles and missing
/// roles.
Report inspection_report(const std::vector<Inspection>& flights);

}  // namespace pcor
