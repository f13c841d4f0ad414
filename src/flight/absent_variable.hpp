#pragma once

#include <string>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/flight/flight.hpp>

namespace pcor::internal {

/// Error for a variable of the model that is absent from the file `path`, with the time series that could
/// replace it: series whose unit converts to `requested` and whose name is similar to `name`; if no name is
/// similar, up to six series whose long names share most words with the role.
Error missing_variable(const std::string& path, const std::vector<VariableInfo>& series,
                       const std::string& name, const std::string& requested, const std::string& role);

}  // namespace pcor::internal
