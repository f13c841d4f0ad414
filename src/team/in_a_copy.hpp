#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pcor::internal {

/// What `work` says of each of 0 ... count-1, where it may be the end of a process: it is done by a copy of
/// this one. Of that with which the copy crashed, or was busy for more than four seconds of processor time,
/// nothing is said, and another copy does those behind it. What they write to standard error is lost.
///
/// To be called while the process has one thread. Work that throws is done again here, and so is all of it
/// where the system begins no more processes.
std::vector<std::optional<std::string>> in_a_copy(std::size_t count,
                                                  const std::function<std::string(std::size_t)>& work);

}  // namespace pcor::internal
