#pragma once

#include <pcor/parallel/communicator.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace pcor {

/// A flight that cannot be opened.
struct UnreadableFlight {
  std::filesystem::path flight{};
  std::string why{};  ///< a sentence
};

/// Flights that can be opened, and those that cannot.
struct ReadableFlights {
  std::vector<std::filesystem::path> flights{};
  std::vector<UnreadableFlight> unreadable{};
};

/// Where flights are opened to see whether they can be.
enum class OpenedIn {
  this_process,
  /// One after another in a copy of this process, which has one thread: where the HDF5 library crashes on a
  /// damaged file, it ends the copy alone. Not for a process of MPI, which must not be copied.
  a_copy
};

/// Opens each flight and closes it again; the team shares the work.
ReadableFlights readable_flights(const std::vector<std::filesystem::path>& flights,
                                 Communicator& comm = serial_communicator(),
                                 OpenedIn location = OpenedIn::this_process);

}  // namespace pcor
