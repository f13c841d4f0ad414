#include <pcor/flight/readable_flights.hpp>

#include <cstddef>

#include <pcor/base/error.hpp>
#include <pcor/flight/flight.hpp>
#include "parallel/flight_partition.hpp"

namespace pcor {

using namespace internal;

namespace {

/// Reason why the file cannot be opened; empty if it can be opened.
std::string trouble_with(const std::filesystem::path& flight) {
  try {
    const Flight opened(flight);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace

ReadableFlights readable_flights(const std::vector<std::filesystem::path>& flights, Communicator& comm) {
  const auto troubles = partition_flights(comm, flights).of_each_flight<std::string>([&](std::size_t number) {
    return trouble_with(flights[number]);
  });
  ReadableFlights readable;
  for (std::size_t number = 0; number < flights.size(); ++number) {
    if (troubles[number].empty()) {
      readable.flights.push_back(flights[number]);
    } else {
      readable.unreadable.push_back({flights[number], troubles[number]});
    }
  }
  return readable;
}

}  // namespace pcor
