#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

#include "events.hpp"

namespace pcor::tool {
namespace {

constexpr std::size_t bar_width = 30;
constexpr auto min_wait = std::chrono::milliseconds(500);

}  // namespace

Progress::Progress(std::string task, bool requested)
    : task_(std::move(task)),
      requested_(requested && (wants_events() || isatty(fileno(stderr)) == 1)),
      last_(wants_events() ? std::chrono::steady_clock::time_point() : std::chrono::steady_clock::now()) {}

Progress::~Progress() { erase(); }

void Progress::show(std::size_t done, std::size_t total) {
  if (!requested_ || total == 0) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < min_wait) return;
  last_ = now;
  if (wants_events()) {
    send_progress(task_, done, total);
    return;
  }
  shown_ = true;
  const std::size_t filled = done * bar_width / total;
  fmt::print(stderr, "\r{} [{:=<{}}{:<{}}] {:3} %", task_, "", filled, "", bar_width - filled,
             done * 100 / total);
  std::fflush(stderr);
}

void Progress::erase() {
  if (!shown_) return;
  fmt::print(stderr, "\r{:<{}}\r", "", task_.size() + bar_width + 9);
  std::fflush(stderr);
}

}  // namespace pcor::tool
