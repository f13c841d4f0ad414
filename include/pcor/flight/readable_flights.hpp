#pragma once

#include <pcor/parallel/communicator.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace pcor {

/// Flight that cannot be opened, with the reason.
struct UnreadableFlight {
  std::filesystem::path flight{};
  std::string why{};  ///< one sentence
};

/// Flights that can be opened, and those that cannot.
struct ReadableFlights {
  std::vector<std::filesystem::path> flights{};
  std::vector<UnreadableFlight> unreadable{};
};

/// Opens and closes each flight; the flights are shared between the ranks.
ReadableFlights readable_flights(const std::vector<std::filesystem::path>& flights,
                                 Communicator& comm = serial_communicator());

}  // namespace pcor
