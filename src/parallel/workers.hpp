#pragma once

#include <pcor/parallel/communicator.hpp>

#include <algorithm>
#include <cstddef>
#include <thread>

namespace pcor::internal {

/// Who shares a work: the members of a team, and in each some threads.
struct Workers {
  Communicator& comm;
  std::size_t threads;  ///< threads of this rank, at least one

  /// @param requested threads; 0: as many as processors, and one in a team of several, which has a processor
  /// for
  ///        each member
  Workers(Communicator& of, std::size_t requested)
      : comm(of),
        threads(requested > 0   ? requested
                : of.size() > 1 ? 1
                                : std::max<std::size_t>(1, std::thread::hardware_concurrency())) {}
};

}  // namespace pcor::internal
