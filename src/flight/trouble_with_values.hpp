#pragma once

#include <string>

#include <pcor/flight/flight.hpp>

namespace pcor::internal {

/// Why a variable that a flight has is no series with a value; empty where it is one.
/// @throws Error if the file is damaged
std::string value_problem(const Flight& flight, const std::string& variable);

}  // namespace pcor::internal
