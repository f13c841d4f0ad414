#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "team/flight_share.hpp"

namespace pcor::internal {

/// The name of each flight's file, and the aircraft that the file says it is of, as `require_one_aircraft`
/// takes them. @throws Error if a flight cannot be read
std::vector<std::pair<std::string, std::string>> aircraft_of_flights(
    const std::vector<std::filesystem::path>& flights, const FlightShare& share);

}  // namespace pcor::internal
