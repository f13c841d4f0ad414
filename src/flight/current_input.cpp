#include "flight/current_input.hpp"

#include <pthread.h>

#include <atomic>
#include <cstddef>
#include <ctime>

namespace pcor {
namespace {

std::atomic<const char*> in_hand{nullptr};
std::atomic<clockid_t> readers_clock{CLOCK_PROCESS_CPUTIME_ID};
std::atomic<double> taken_at{0.0};
std::atomic<double> begun_at{0.0};
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

const char* current_input_path() noexcept { return in_hand; }

bool had_previous_input() noexcept { return has_others; }

double current_input_seconds() noexcept { return in_hand ? seconds_of(readers_clock) - taken_at : 0.0; }

double seconds_of_waiting() noexcept {
  constexpr double works = 0.1;  // s
  return in_hand != nullptr && current_input_seconds() < works ? seconds_of(CLOCK_MONOTONIC) - begun_at : 0.0;
}

internal::FileInHand::FileInHand(const std::filesystem::path& path) noexcept : before_(in_hand) {
  clockid_t clock = CLOCK_PROCESS_CPUTIME_ID;
  pthread_getcpuclockid(pthread_self(), &clock);
  readers_clock = clock;
  taken_at = seconds_of(clock);
  begun_at = seconds_of(CLOCK_MONOTONIC);
  in_hand = path.c_str();
  const std::size_t hash = std::filesystem::hash_value(path);
  std::size_t none = 0;
  if (!first_path.compare_exchange_strong(none, hash) && none != hash) has_others = true;
}

internal::FileInHand::~FileInHand() { in_hand = before_; }

}  // namespace pcor
