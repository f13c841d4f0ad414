#pragma once

#include <string>
#include <vector>

#include <pcor/process/process_flights.hpp>
#include <pcor/report/report.hpp>

namespace pcor {

/// Page of `pcor process`: outputs read back at one sample for each record. Delta-p in time and by flight
/// state, the other results, the difference from the static pressure corrected in the input file, with mean
/// and scatter for each state of the flaps, and the number of samples with each quality bit. A flight that
/// could not be read is listed in the table only.
/// @param suffix suffix of the derived variables, as in `ProcessOptions`
/// @throws Error if an output, or an input of it, cannot be read
Report process_report(const std::vector<ProcessedFlight>& flights, const std::string& suffix);

}  // namespace pcor
