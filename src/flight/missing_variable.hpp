#pragma once

#include <string>
#include <vector>

#include <pcor/flight/flight.hpp>
#include "flight/flight_file.hpp"

namespace pcor::internal {

/// Throws the error for a variable of the model that is absent from the file, with the time series that could
/// replace it: series whose unit converts to `requested` and whose name is similar to `name`; if no name is
/// similar, up to six series whose long names share most words with the role. Corrected pressures are not
/// proposed.
[[noreturn]] void refuse_missing(const FlightFile& file, const std::vector<VariableInfo>& variables,
                                 const std::string& name, const std::string& requested,
                                 const std::string& role);

}  // namespace pcor::internal
