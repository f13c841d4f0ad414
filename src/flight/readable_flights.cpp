#include <pcor/flight/readable_flights.hpp>

#include <pcor/flight/flight.hpp>
#include <pcor/words/error.hpp>
#include "team/flight_share.hpp"

namespace pcor {

using namespace internal;

ReadableFlights readable_flights(const std::vector<std::filesystem::path>& flights, Team& team) {
  const std::vector<std::string> troubles =
      share_of_flights(team, flights).of_each_flight<std::string>([&](std::size_t number) {
        try {
          const Flight opened(flights[number]);
          return std::string();
        } catch (const Error& error) {
          return std::string(error.what());
        }
      });
  ReadableFlights readable;
  for (std::size_t number = 0; number < flights.size(); ++number) {
    if (troubles[number].empty()) {
      readable.flights.push_back(flights[number]);
    } else {
      readable.troubles.push_back(troubles[number]);
    }
  }
  return readable;
}

}  // namespace pcor
