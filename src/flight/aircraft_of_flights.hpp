#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <pcor/flight/flight.hpp>
#include "team/flight_share.hpp"

namespace pcor::internal {

/// The name of each flight's file, and the aircraft that the file says it is of, as `require_one_aircraft`
/// takes them. @param time_stamp as the flights are opened for their samples, so that those that stay open
/// are opened once @throws Error if a flight cannot be read
std::vector<std::pair<std::string, std::string>> aircraft_of_flights(
    const std::vector<std::filesystem::path>& flights, const FlightShare& share, TimeStamp time_stamp);

}  // namespace pcor::internal
