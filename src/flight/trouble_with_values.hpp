#pragma once

#include <string>

#include <pcor/flight/flight.hpp>

namespace pcor::internal {

/// Reason why an existing variable is not a time series with values; empty if it is. @throws Error if the
/// file is damaged
std::string value_problem(const Flight& flight, const std::string& variable);

}  // namespace pcor::internal
