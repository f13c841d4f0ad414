#pragma once

#include <pcor/fit/refit.hpp>
#include <pcor/report/report.hpp>

#include <vector>

namespace pcor::internal {

/// Adds the picture of the held-out parts to a report, and a sentence to its summary if one of them is
/// biased. Does nothing if no part is held out.
void add_held_out(Report& report, const std::vector<FlightFit>& flights);

}  // namespace pcor::internal
