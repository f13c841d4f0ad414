#pragma once

#include <pcor/parallel/communicator.hpp>

namespace pcor::tool {

/// Communicator of this process: serial, unless `set_communicator` was called.
Communicator& comm();
void set_communicator(Communicator& comm);

/// Whether this rank prints and writes the results: true on the first rank.
bool is_speaker();

}  // namespace pcor::tool
