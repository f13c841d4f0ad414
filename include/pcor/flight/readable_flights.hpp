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

/// Where flights are opened to see whether they can be.
enum class OpenedIn {
  this_process,
  /// One after another in a copy of this process, which has one thread: where the HDF5 library crashes on a
  /// damaged file, it ends the copy alone. Not for a process of MPI, which must not be copied.
  a_copy
};

/// Opens each flight and closes it again; the team shares the work.
ReadableFlights readable_flights(const std::vector<std::filesystem::path>& flights, Team& team = alone(),
                                 OpenedIn where = OpenedIn::this_process);

}  // namespace pcor
