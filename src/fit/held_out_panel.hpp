#pragma once

#include <pcor/fit/refit.hpp>
#include <pcor/report/report.hpp>

#include <vector>

namespace pcor::internal {

/// Adds the picture of the held-out parts to a report, and a sentence to its summary where one of them is
/// off. Nothing where nothing is held out.
void add_held_out(Report& report, const std::vector<FlightFit>& flights);

}  // namespace pcor::internal
