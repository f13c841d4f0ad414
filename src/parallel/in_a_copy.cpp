#include "parallel/in_a_copy.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>

#include "parallel/forked_process.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t max_letters = 10000;

/// Handlers of this process for terminating signals are reset in the child process; ignored signals remain
/// ignored.
void reset_signals() {
  for (int signal = 1; signal < NSIG; ++signal) {
    if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

/// A crash that the parent process reports is not reported by the system as well.
void crash_in_silence() {
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
#endif
}

[[noreturn]] void work_and_end(int connection, std::size_t first, std::size_t count, int max_seconds,
                               const std::function<std::string(std::size_t)>& work) {
  reset_signals();
  crash_in_silence();
  try {
    for (std::size_t i = first; i < count; ++i) {
      const itimerval limit{{0, 0}, {max_seconds, 0}};
      ::setitimer(ITIMER_PROF, &limit, nullptr);
      if (!send_text(connection, work(i))) break;
    }
  } catch (...) {  // who made the copy does the work again, and throws it
  }
  ::_exit(0);
}

bool is_crash(const std::optional<int>& end) {
  constexpr std::array crashes{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGPROF};
  return end && WIFSIGNALED(*end) &&
         std::find(crashes.begin(), crashes.end(), WTERMSIG(*end)) != crashes.end();
}

}  // namespace

std::vector<std::optional<std::string>> in_a_copy(std::size_t count, int max_seconds,
                                                  const std::function<std::string(std::size_t)>& work) {
  std::vector<std::optional<std::string>> results(count);
  for (std::size_t i = 0; i < count;) {
    const std::size_t first = i;
    const std::optional<ForkedProcess> copied = fork_process(SIGKILL);
    if (copied && copied->is_copy) work_and_end(copied->other.connection, first, count, max_seconds, work);
    bool crashed = false;
    if (copied) {
      for (std::string text; i < count && receive_text(copied->other.connection, text, max_letters); ++i)
        results[i] = text;
      ::close(copied->other.connection);
      crashed = is_crash(end_of(copied->other.process));
    }
    if (i == count) break;
    if (!crashed) {
      results[i] = work(i);
      ++i;
    } else if (i == first) {
      ++i;  // an earlier task in the same child process may be the cause, so only the first task of a child
            // is reported
    }
  }
  return results;
}

}  // namespace pcor::internal
