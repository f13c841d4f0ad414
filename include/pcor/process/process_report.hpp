#pragma once

#include <string>
#include <vector>

#include <pcor/process/process_flights.hpp>
#include <pcor/report/report.hpp>

namespace pcor {

/// The page of `pcor process`: what was made of the flights, read back from their outputs at one sample for
/// each record. Delta-p in time and by the state of flight, what is written beside it, how it differs from
/// what the flight's own processing corrected, and how many samples have which quality bit. A flight that
/// could not be read is a row of the table alone.
/// @param suffix of the derived variables, as in `ProcessOptions`
/// @throws Error if an output, or an input of it, cannot be read
Report process_report(const std::vector<ProcessedFlight>& flights, const std::string& suffix);

}  // namespace pcor
