#pragma once

#include <pcor/team/team.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace pcor {

/// Flights that can be opened, and why the others cannot.
struct ReadableFlights {
  std::vector<std::filesystem::path> flights{};
  std::vector<std::string> troubles{};  ///< a sentence for each flight that is left out
};

/// Opens each flight and closes it again; the team shares the work.
ReadableFlights readable_flights(const std::vector<std::filesystem::path>& flights, Team& team = alone());

}  // namespace pcor
