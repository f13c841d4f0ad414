#pragma once

#include <vector>

#include <pcor/inspect/inspect.hpp>
#include <pcor/report/report.hpp>

namespace pcor {

/// The page of `pcor inspect`: track, height, speed and regimes of the flights, and the tables of roles and
/// of what is missing.
Report inspection_report(const std::vector<Inspection>& flights);

}  // namespace pcor
