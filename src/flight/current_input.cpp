#include "flight/current_input.hpp"

#include <pthread.h>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <ctime>

namespace pcor {
namespace {

std::atomic<const char*> current_path{nullptr};
std::atomic<clockid_t> readers_clock{CLOCK_PROCESS_CPUTIME_ID};
std::atomic<double> taken_at{0.0};
std::atomic<double> worked_until{0.0};   // processor time
std::atomic<double> worked_at{0.0};      // wall-clock time
std::atomic<std::size_t> first_path{0};  // its hash; 0 if no file is being read
std::atomic<bool> has_others{false};
static_assert(std::atomic<const char*>::is_always_lock_free && std::atomic<clockid_t>::is_always_lock_free &&
              std::atomic<double>::is_always_lock_free);

double seconds_of(clockid_t clock) noexcept {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

const char* current_input_path() noexcept { return current_path; }

bool had_previous_input() noexcept { return has_others; }

double current_input_seconds() noexcept { return current_path ? seconds_of(readers_clock) - taken_at : 0.0; }

double seconds_of_waiting() noexcept {
  constexpr double works = 0.01;  // s, more than the signal handlers use in half a minute
  if (current_path == nullptr) return 0.0;
  const double used = seconds_of(readers_clock), now = seconds_of(CLOCK_MONOTONIC);
  if (std::abs(used - worked_until) >= works) {
    worked_until = used;
    worked_at = now;
  }
  return now - worked_at;
}

internal::CurrentInput::CurrentInput(const std::filesystem::path& path) noexcept : before_(current_path) {
  clockid_t clock = CLOCK_PROCESS_CPUTIME_ID;
  pthread_getcpuclockid(pthread_self(), &clock);
  readers_clock = clock;
  taken_at = worked_until = seconds_of(clock);
  worked_at = seconds_of(CLOCK_MONOTONIC);
  current_path = path.c_str();
  const std::size_t hash = std::filesystem::hash_value(path);
  std::size_t none = 0;
  if (!first_path.compare_exchange_strong(none, hash) && none != hash) has_others = true;
}

internal::CurrentInput::~CurrentInput() { current_path = before_; }

}  // namespace pcor
