#pragma once

#include <pcor/parallel/communicator.hpp>

namespace pcor::tool {

/// The team that this process works in: itself alone, unless `set_communicator` said otherwise.
Communicator& comm();
void set_communicator(Communicator& comm);

/// Whether this member of the team says and writes what comes of the work: the first does, for all.
bool is_speaker();

}  // namespace pcor::tool
