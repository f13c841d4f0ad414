#pragma once

#include <pcor/parallel/communicator.hpp>

namespace pcor::tool {

/// End of the program.
struct Ending {
  int status = 0;  ///< 0 done, 1 the work could not be done, 2 usage
  /// A file could not be written or read, or memory was exhausted: HDF5 would retry at exit, and crash.
  bool at_once = false;
};

/// Parses the command line and runs it, in the requested number of processes.
Ending run_program(int argc, char** argv);

/// Runs the command line as one of the ranks.
/// @param status_of_crash exit status of this process if a library crashes
Ending run_program(int argc, char** argv, Communicator& comm, int status_of_crash = 1);

/// Ends this process with the given status.
[[noreturn]] void end_process(const Ending& ending);

}  // namespace pcor::tool
