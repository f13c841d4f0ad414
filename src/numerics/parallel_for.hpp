#pragma once

#include <cstddef>
#include <functional>

namespace pcor::internal {

/// Calls `work` with each of 0 ... count-1 once, in any order, `threads` at a time; with 0 threads as many as
/// there are processors. Where a call throws, no further begins, and what one of them threw is
/// thrown when those that had begun have ended.
void parallel_for(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& work);

}  // namespace pcor::internal
