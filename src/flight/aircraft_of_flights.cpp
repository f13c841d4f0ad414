#include "flight/aircraft_of_flights.hpp"

namespace pcor::internal {

std::vector<std::pair<std::string, std::string>> aircraft_of_flights(
    const std::vector<std::filesystem::path>& flights, const FlightShare& share, TimeStamp time_stamp) {
  const auto aircraft = share.of_each_flight<std::string>(
      [&](std::size_t number) { return Flight(flights[number], time_stamp).aircraft(); });
  std::vector<std::pair<std::string, std::string>> named;
  for (std::size_t i = 0; i < flights.size(); ++i)
    named.emplace_back(flights[i].filename().string(), aircraft[i]);
  return named;
}

}  // namespace pcor::internal
