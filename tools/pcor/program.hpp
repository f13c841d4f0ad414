#pragma once

#include <pcor/parallel/communicator.hpp>

namespace pcor::tool {

/// How the program ended.
struct Ending {
  int status = 0;  ///< 0 done, 1 the work could not be done, 2 usage
  /// A file could not be written or read, or memory was short: HDF5 would try once more at the exit, and
  /// crash.
  bool at_once = false;
};

/// Reads the command line and does what it says, in as many processes as it asks for.
Ending run_program(int argc, char** argv);

/// The same, together with the other members of the team.
/// @param status_of_crash with which this process ends where a library crashes
Ending run_program(int argc, char** argv, Communicator& comm, int status_of_crash = 1);

/// Ends this process so.
[[noreturn]] void end_process(const Ending& ending);

}  // namespace pcor::tool
