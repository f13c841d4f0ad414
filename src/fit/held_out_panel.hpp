#pragma once

#include <pcor/fit/refit.hpp>
#include <pcor/report/report.hpp>

#include <vector>

namespace pcor::internal {

/// Adds a sentence to the summary of a report if a held-out part is biased.
void summarise_held_out(Report& report, const std::vector<FlightFit>& flights);

/// Adds the picture of the held-out parts to a report, if there are any.
void add_held_out(Report& report, const std::vector<FlightFit>& flights);

}  // namespace pcor::internal
