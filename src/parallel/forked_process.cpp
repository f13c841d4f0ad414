#include "parallel/forked_process.hpp"

#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>

namespace pcor::internal {
namespace {

bool send_all(int connection, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t sent = ::send(connection, bytes, count, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) {
      if (errno == EPIPE || errno == ECONNRESET) errno = 0;
      return false;
    }
    bytes += sent;
    count -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool receive_all(int connection, char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t received = ::recv(connection, bytes, count, 0);
    if (received < 0 && errno == EINTR) continue;
    if (received <= 0) {
      if (received == 0 || errno == ECONNRESET) errno = 0;
      return false;
    }
    bytes += received;
    count -= static_cast<std::size_t>(received);
  }
  return true;
}

}  // namespace

std::optional<ForkedProcess> fork_process(int when_alone) {
  const pid_t first = ::getpid();
  int ends[2] = {-1, -1};
  const bool is_connected = ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) == 0;
  const pid_t process = is_connected ? ::fork() : -1;
  if (process < 0) {
    const int why = errno;
    for (const int end : ends) ::close(end);
    errno = why;
    return std::nullopt;
  }
  if (process > 0) {
    ::close(ends[1]);
    return ForkedProcess{{process, ends[0]}, false};
  }
  ::prctl(PR_SET_PDEATHSIG, when_alone);
  if (::getppid() != first) ::_exit(1);
  ::close(ends[0]);
  return ForkedProcess{{first, ends[1]}, true};
}

bool send_text(int connection, const std::string& text) {
  const std::uint64_t count = text.size();
  return send_all(connection, reinterpret_cast<const char*>(&count), sizeof count) &&
         send_all(connection, text.data(), text.size());
}

bool receive_text(int connection, std::string& text, std::uint64_t maximum) {
  std::uint64_t count = 0;
  if (!receive_all(connection, reinterpret_cast<char*>(&count), sizeof count) || count > maximum)
    return false;
  text.resize(count);
  return receive_all(connection, text.data(), text.size());
}

std::optional<int> end_of(int process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0)
    if (errno != EINTR) return std::nullopt;
  return status;
}

}  // namespace pcor::internal
