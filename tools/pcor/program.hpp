#pragma once

#include <pcor/parallel/communicator.hpp>

namespace pcor::tool {

/// End of the program.
struct Ending {
  int status = 0;  ///< 0 done, 1 the work could not be done, 2 usage
  /// A file could not be written or read, or memory was exhausted: HDF5 would retry at exit, and crash.
  bool at_once = false;
};

/// Parses the command line and runs it, as one of the ranks.
Ending run_program(int argc, char** argv, Communicator& comm);

/// Ends this process with the given status.
[[noreturn]] void end_process(const Ending& ending);

}  // namespace pcor::tool
