#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pcor::internal {

/// Returns the result of `work` for each of 0 ... count-1, if it may crash or hang: it runs in a child
/// process, one task after another. If that process ends by a crash signal, or after `max_seconds` of
/// processor time for one task, only this task has no result; the remaining tasks run in another child
/// process. Waiting time is not limited. Output to standard error is discarded, except in a build with a
/// sanitizer.
///
/// The calling process must have one thread. If a child process ends otherwise, for example by an exception
/// of `work`, or the system starts no more processes, the work is done in the calling process.
///
/// @param work returns a text of at most 10,000 characters and has no side effects in this process
/// @return in the order of the numbers
std::vector<std::optional<std::string>> in_a_copy(std::size_t count, int max_seconds,
                                                  const std::function<std::string(std::size_t)>& work);

}  // namespace pcor::internal
