#include "events.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "communicator.hpp"

namespace pcor::tool {
namespace {

/// The file descriptor for events; 0 without PCOR_EVENTS, or if the descriptor is not a pipe or a socket.
int descriptor() {
  static const int number = [] {
    const char* const given = std::getenv("PCOR_EVENTS");
    const int number_given = given == nullptr ? 0 : static_cast<int>(std::strtol(given, nullptr, 10));
    struct stat status {};
    const bool is_open = fstat(number_given, &status) == 0;
    return is_open && (S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode)) ? number_given : 0;
  }();
  return number;
}

void send(const nlohmann::ordered_json& event) {
  if (!wants_events()) return;
  const std::string line = event.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  [[maybe_unused]] const auto written = write(descriptor(), line.data(), line.size());
}

}  // namespace

bool wants_events() { return descriptor() > STDERR_FILENO && is_speaker(); }

void send_progress(const std::string& task, std::size_t done, std::size_t total) {
  send({{"task", task}, {"done", done}, {"total", total}});
}

void send_error(const std::string& message, std::string_view code) {
  send({{"error", message}, {"code", code}});
}

}  // namespace pcor::tool
