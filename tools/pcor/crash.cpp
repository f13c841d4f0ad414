#include "crash.hpp"

#include <sys/time.h>
#include <unistd.h>

#include <csignal>
#include <cstddef>
#include <cstring>
#include <initializer_list>

#include <pcor/flight/file_in_hand.hpp>
#include <pcor/words/replacement_file.hpp>

namespace pcor::tool {
namespace {

constexpr int work_not_done = 1;
constexpr double most_seconds = 4;  // a hundred times what is usual
constexpr std::size_t stack_bytes = std::size_t{64} << 10;

void print(const char* text) {
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text, std::strlen(text));
}

[[noreturn]] void give_up(const char* file) {
  print("pcor: ");
  print(file);
  print(" is damaged: the HDF5 library could not read it; fetch it again from its source\n");
  _exit(work_not_done);
}

extern "C" void explain(int signal) {
  remove_unfinished_files();
  if (const char* const file = file_in_hand()) give_up(file);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

extern "C" void watch(int /*signal*/) {
  const char* const file = file_in_hand();
  if (file == nullptr || seconds_in_hand() < most_seconds) return;
  remove_unfinished_files();
  give_up(file);
}

void handle(std::initializer_list<int> signals, void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_ONSTACK | flags;
  for (const int signal : signals) sigaction(signal, &action, nullptr);
}

}  // namespace

void explain_crashes() {
  // A stack of its own: the library's may be used up.
  static std::byte stack[stack_bytes];
  stack_t place{};
  place.ss_sp = stack;
  place.ss_size = sizeof stack;
  sigaltstack(&place, nullptr);
  handle({SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}, explain, static_cast<int>(SA_RESETHAND));
  handle({SIGPROF}, watch, SA_RESTART);
  const itimerval each_second{{1, 0}, {1, 0}};  // of processor time
  setitimer(ITIMER_PROF, &each_second, nullptr);
}

}  // namespace pcor::tool
