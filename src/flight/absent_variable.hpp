#pragma once

#include <string>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/flight/flight.hpp>

namespace pcor::internal {

/// That a variable of the model is absent from the file `path`, and which of its time series could take its
/// place: those whose unit converts to `wanted`, and of these the namesakes of `name`, or else up to six
/// whose long names share most words with the role.
Error missing_variable(const std::string& path, const std::vector<VariableInfo>& series,
                       const std::string& name, const std::string& wanted, const std::string& role);

}  // namespace pcor::internal
