#pragma once

#include <pcor/parallel/communicator.hpp>

#include <algorithm>
#include <cstddef>
#include <thread>

namespace pcor::internal {

/// Ranks of a communicator that share work, and threads of each.
struct Workers {
  Communicator& comm;
  std::size_t threads;  ///< threads of this rank, at least one

  /// @param requested threads; 0: as many as processors, and one if there are several ranks, which have a
  /// processor each
  Workers(Communicator& of, std::size_t requested)
      : comm(of),
        threads(requested > 0   ? requested
                : of.size() > 1 ? 1
                                : std::max<std::size_t>(1, std::thread::hardware_concurrency())) {}
};

}  // namespace pcor::internal
