#include "crash.hpp"

#include <dlfcn.h>
#include <execinfo.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string_view>

#include <pcor/base/atomic_file.hpp>
#include <pcor/base/message.hpp>
#include <pcor/flight/current_input.hpp>

namespace pcor::tool {
namespace {

constexpr std::size_t stack_bytes = std::size_t{64} << 10;
constexpr int seconds_between_looks = 5;
constexpr int status_of_crash = 1;
constexpr std::array crashes{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

std::array<struct sigaction, crashes.size()> earlier;  // handlers of a sanitizer, if any
volatile std::sig_atomic_t is_running = 0;

void print(std::string_view text) {
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
}

/// @param file that was being read; null if unknown
[[noreturn]] void give_up(const char* file) {
  remove_unfinished_files();
  print("pcor: ");
  if (file != nullptr) {
    put_sanitized(file, print);
    print(
        had_previous_input()
            ? ": this flight or one read before it is damaged: the HDF5 library failed; find it with pcor "
              "inspect, and fetch it again from its source\n"
            : ": the file is damaged: the HDF5 library could not read it; fetch it again from its source\n");
  } else {
    print(
        "a library that reads and writes files failed, for example because the memory or the disk is full; "
        "free space, or give fewer flights\n");
  }
  _exit(status_of_crash);
}

/// Code that is running.
enum class Busy { other, library, reader_of_flights };

/// Only shared libraries can be identified by name.
Busy what_is_busy() {
  constexpr int max_frames = 64;
  void* frames[max_frames];
  const int count = backtrace(frames, max_frames);
  Busy found = Busy::other;
  for (int i = 0; i < count; ++i) {
    Dl_info location{};
    if (dladdr(frames[i], &location) == 0 || location.dli_fname == nullptr) continue;
    const auto is = [&location](const char* name) {
      return std::strstr(location.dli_fname, name) != nullptr;
    };
    // Libraries for units and digests do not read flights, which may be damaged.
    if (is("/libudunits") || is("/libcrypto")) return Busy::library;
    if (is("/libhdf5") || is("/libnetcdf")) found = Busy::reader_of_flights;
  }
  return found;
}

extern "C" void explain(int signal) {
  remove_unfinished_files();  // before the stack is inspected, which may be damaged as well
  const Busy busy = what_is_busy();
  if (busy != Busy::other) give_up(busy == Busy::reader_of_flights ? current_input_path() : nullptr);
  for (std::size_t i = 0; i < crashes.size(); ++i)
    if (crashes[i] == signal) sigaction(signal, &earlier[i], nullptr);
  std::raise(signal);
}

extern "C" void watch(int /*signal*/) {
  if (current_input_path() != nullptr && current_input_seconds() >= max_seconds_per_input)
    give_up(current_input_path());
}

extern "C" void watch_waiting(int /*signal*/) {
  const char* const file = current_input_path();
  static volatile std::sig_atomic_t times = 0;  // few ticks pass while a user has stopped the program
  const double waiting = seconds_of_waiting();
  times = waiting < 0.9 * seconds_between_looks ? 0 : times + 1;
  if (file == nullptr || waiting < max_seconds_of_waiting ||
      times * seconds_between_looks < max_seconds_of_waiting)
    return;
  remove_unfinished_files();
  print("pcor: ");
  put_sanitized(file, print);
  print(
      ": no data for half a minute; the path may be a pipe or an unavailable disk; copy the file and give "
      "the copy\n");
  _exit(status_of_crash);
}

/// Libraries end a program if memory is exhausted.
extern "C" void explain_exit() {
  if (is_running != 0) give_up(nullptr);
}

void handle(int signal, void (*handler)(int), int flags, struct sigaction* before) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_ONSTACK | flags;
  sigaction(signal, &action, before);
}

}  // namespace

CrashesExplained::CrashesExplained() {
  what_is_busy();  // the first backtrace loads a library, which a signal handler must not do
  // Separate stack: the stack of the library may be exhausted.
  static std::byte stack[stack_bytes];
  stack_t alternate{};
  alternate.ss_sp = stack;
  alternate.ss_size = sizeof stack;
  sigaltstack(&alternate, nullptr);
  for (std::size_t i = 0; i < crashes.size(); ++i)
    handle(crashes[i], explain, static_cast<int>(SA_RESETHAND), &earlier[i]);
  handle(SIGPROF, watch, SA_RESTART, nullptr);
  const itimerval each_second{{1, 0}, {1, 0}};  // processor time
  setitimer(ITIMER_PROF, &each_second, nullptr);
  handle(SIGVTALRM, watch_waiting, SA_RESTART, nullptr);
  sigevent event{};
  event.sigev_notify = SIGEV_SIGNAL;
  event.sigev_signo = SIGVTALRM;
  timer_t timer{};
  const itimerspec sometimes{{seconds_between_looks, 0}, {seconds_between_looks, 0}};  // wall-clock time
  if (timer_create(CLOCK_MONOTONIC, &event, &timer) == 0) timer_settime(timer, 0, &sometimes, nullptr);
  is_running = 1;
  std::atexit(explain_exit);
}

CrashesExplained::~CrashesExplained() { is_running = 0; }

}  // namespace pcor::tool
