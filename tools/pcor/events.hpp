#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pcor::tool {

/// Whether the program that started this one wants events: the environment variable PCOR_EVENTS then is the
/// number of an open file descriptor.
bool wants_events();

/// Writes there one line of JSON on the progress of the work: `{"task", "done", "total"}`. The first rank
/// writes, for all.
void send_progress(const std::string& task, std::size_t done, std::size_t total);

/// Writes there one line of JSON on an error: `{"error", "code"}`.
void send_error(const std::string& message, std::string_view code);

}  // namespace pcor::tool
