#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pcor::internal {

/// What `work` returns for each of 0 ... count-1, where it may crash, or never come back: it is done in a
/// copy of this process, one after another. Where that copy is ended by a signal of a crash, or
/// after `max_seconds` of processor time for one of them, it is that one alone that has no result; those
/// behind it are done in another copy. Time in which the copy only waits has no end. What it writes to
/// standard error is lost, but in a build with a sanitizer.
///
/// To be called while the process has one thread. Where a copy ends otherwise, as by what `work`
/// throws, or the system begins no more processes, the work is done here.
///
/// @param work gives a text of 10,000 letters at most, and leaves nothing in this process
/// @return in the order of the numbers
std::vector<std::optional<std::string>> in_a_copy(std::size_t count, int max_seconds,
                                                  const std::function<std::string(std::size_t)>& work);

}  // namespace pcor::internal
