#pragma once

#include <nlohmann/json.hpp>

namespace pcor::tool {

/// Whether the program that started this one wants events: the environment variable PCOR_EVENTS then is the
/// number of an open file descriptor.
bool wants_events();

/// Writes `event` there as one line of JSON: progress of the work, `{"task", "done", "total"}`, and an error,
/// `{"error", "code"}`. The first member of a team writes, for all.
void send_event(const nlohmann::ordered_json& event);

}  // namespace pcor::tool
