#include <pcor/flight/readable_flights.hpp>

#include <cstddef>
#include <optional>

#include <pcor/base/error.hpp>
#include <pcor/flight/current_input.hpp>
#include <pcor/flight/flight.hpp>
#include "parallel/flight_partition.hpp"
#include "parallel/in_a_copy.hpp"

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

ReadableFlights readable_flights(const std::vector<std::filesystem::path>& flights, Communicator& comm,
                                 OpenedIn where) {
  const FlightPartition share = partition_flights(comm, flights);
  const auto troubles = share.gather_flights<std::string>([&](std::vector<std::string>& all) {
    std::vector<std::size_t> own;
    for (std::size_t number = 0; number < flights.size(); ++number) {
      if (share.owns(number)) own.push_back(number);
    }
    const auto trouble = [&](std::size_t k) { return trouble_with(flights[own[k]]); };
    if (where == OpenedIn::this_process) {
      for (std::size_t k = 0; k < own.size(); ++k) all[own[k]] = trouble(k);
      return;
    }
    const std::vector<std::optional<std::string>> said =
        in_a_copy(own.size(), max_seconds_per_input, trouble);
    for (std::size_t k = 0; k < own.size(); ++k) {
      all[own[k]] =
          said[k].value_or(flights[own[k]].string() +
                           ": a copy of the program crashed where it was opened, as the HDF5 library does on "
                           "a damaged file; fetch it again from its source");
    }
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
