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
#include <initializer_list>

#include <pcor/flight/file_in_hand.hpp>
#include <pcor/words/replacement_file.hpp>

namespace pcor::tool {
namespace {

constexpr int work_not_done = 1;
constexpr double most_seconds = 4;  // a hundred times what is usual
constexpr std::size_t stack_bytes = std::size_t{64} << 10;
constexpr std::array crashes{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

std::array<struct sigaction, crashes.size()> earlier;  // a sanitizer's, where there is one
volatile std::sig_atomic_t is_running = 0;

void print(const char* text) {
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text, std::strlen(text));
}

/// @param file that is damaged; null where none is
[[noreturn]] void give_up(const char* file) {
  remove_unfinished_files();
  print("pcor: ");
  if (file != nullptr) {
    print(file);
    print(" is damaged: the HDF5 library could not read it; fetch it again from its source\n");
  } else {
    print(
        "a library that reads and writes files failed, as where the memory or the disk is full; make room, "
        "or give fewer flights at a time\n");
  }
  _exit(work_not_done);
}

/// Whether one of some libraries is in the middle of something: of those that are shared, as only these can
/// be told by name.
bool is_in(std::initializer_list<const char*> libraries) {
  constexpr int most_frames = 64;
  void* frames[most_frames];
  const int count = backtrace(frames, most_frames);
  for (int i = 0; i < count; ++i) {
    Dl_info place{};
    if (dladdr(frames[i], &place) == 0 || place.dli_fname == nullptr) continue;
    for (const char* const library : libraries)
      if (std::strstr(place.dli_fname, library) != nullptr) return true;
  }
  return false;
}

extern "C" void explain(int signal) {
  remove_unfinished_files();  // before a look at a stack that may be damaged, too
  if (is_in({"/libudunits", "/libcrypto"}))
    give_up(nullptr);  // which meet with no damage that was not looked for
  if (is_in({"/libhdf5", "/libnetcdf"})) give_up(file_in_hand());
  for (std::size_t i = 0; i < crashes.size(); ++i)
    if (crashes[i] == signal) sigaction(signal, &earlier[i], nullptr);
  std::raise(signal);
}

extern "C" void watch(int /*signal*/) {
  if (file_in_hand() != nullptr && seconds_in_hand() >= most_seconds) give_up(file_in_hand());
}

/// Libraries end a program where they get no memory.
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
  is_in({});  // the first time loads what it needs
  // A stack of its own: the library's may be used up.
  static std::byte stack[stack_bytes];
  stack_t place{};
  place.ss_sp = stack;
  place.ss_size = sizeof stack;
  sigaltstack(&place, nullptr);
  for (std::size_t i = 0; i < crashes.size(); ++i)
    handle(crashes[i], explain, static_cast<int>(SA_RESETHAND), &earlier[i]);
  handle(SIGPROF, watch, SA_RESTART, nullptr);
  const itimerval each_second{{1, 0}, {1, 0}};  // of processor time
  setitimer(ITIMER_PROF, &each_second, nullptr);
  is_running = 1;
  std::atexit(explain_exit);
}

CrashesExplained::~CrashesExplained() { is_running = 0; }

}  // namespace pcor::tool
