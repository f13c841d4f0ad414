#include <pcor/flight/readable_flights.hpp>

#include <cstddef>

#include <pcor/base/error.hpp>
#include <pcor/flight/flight.hpp>
#include "parallel/flight_partition.hpp"

namespace pcor {

std::vector<std::string> reasons_unreadable(const std::vector<std::filesystem::path>& flights,
                                            Communicator& comm) {
  return internal::partition_flights(comm, flights)
      .all_gather_flights<std::string>([&](std::size_t number) -> std::string {
        try {
          const Flight opened(flights[number]);
          return "";
        } catch (const Error& error) {
          return error.what();
        }
      });
}

}  // namespace pcor
