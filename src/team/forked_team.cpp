#include <pcor/team/forked_team.hpp>

#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>

namespace pcor {
namespace {

// Those that follow leave errno at 0 where the other process has ended.

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

bool send_text(int connection, const std::string& text) {
  const std::uint64_t count = text.size();
  return send_all(connection, reinterpret_cast<const char*>(&count), sizeof count) &&
         send_all(connection, text.data(), text.size());
}

bool receive_text(int connection, std::string& text) {
  std::uint64_t count = 0;
  if (!receive_all(connection, reinterpret_cast<char*>(&count), sizeof count)) return false;
  text.resize(count);
  return receive_all(connection, text.data(), text.size());
}

/// What the process ended with, as waitpid has it; nothing where the system has forgotten it.
std::optional<int> end_of(int process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0)
    if (errno != EINTR) return std::nullopt;
  return status;
}

}  // namespace

ForkedTeam::ForkedTeam(std::size_t size) : size_(size) {
  const pid_t first = ::getpid();
  for (std::size_t rank = 1; rank < size; ++rank) {
    int ends[2] = {-1, -1};
    const bool is_connected = ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) == 0;
    const pid_t process = is_connected ? ::fork() : -1;
    if (process < 0) {
      const std::string why = std::strerror(errno);
      for (const int end : ends) ::close(end);
      let_go(true);
      throw Error(fmt::format("{} processes cannot be begun: {}; ask for fewer", size, why));
    }
    if (process > 0) {
      ::close(ends[1]);
      others_.push_back({process, ends[0]});
      continue;
    }
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != first) ::_exit(1);
    for (const Other& other : others_) ::close(other.connection);
    ::close(ends[0]);
    rank_ = rank;
    others_ = {{first, ends[1]}};
    return;
  }
}

ForkedTeam::~ForkedTeam() { let_go(loss_.has_value()); }

/// @param at_once the copies end where they are, and not with the work
void ForkedTeam::let_go(bool at_once) {
  for (const Other& other : others_) ::close(other.connection);
  for (const Other& other : others_) {
    if (rank_ > 0) continue;
    if (at_once) ::kill(other.process, SIGTERM);
    end_of(other.process);
  }
  others_.clear();
}

Error ForkedTeam::loss_of(const Other& other, int why) const {
  constexpr const char* fewer = "give fewer processes, or fewer flights at a time";
  if (why != 0)
    return Error(fmt::format("the {} processes of this run cannot reach each other: {}; {}", size_,
                             std::strerror(why), fewer));
  if (rank_ > 0) return Error("the first process of this run has ended");
  const std::optional<int> end = end_of(other.process);
  if (end && WIFEXITED(*end) && WEXITSTATUS(*end) == has_told) return Error("");
  const std::string which = fmt::format("one of the {} processes of this run ", size_);
  if (end && WIFSIGNALED(*end) && WTERMSIG(*end) != SIGKILL)
    return Error(
        fmt::format("{}was ended by the signal \"{}\"; give the command again, and report it if that "
                    "happens again",
                    which, ::strsignal(WTERMSIG(*end))));
  const bool is_killed = end && WIFSIGNALED(*end);
  return Error(fmt::format("{}, as where the memory is short; {}",
                           which + (is_killed ? "was killed" : "ended before the others"), fewer));
}

void ForkedTeam::require(bool is_done, const Other& other) {
  if (is_done) return;
  loss_ = loss_of(other, errno);
  throw *loss_;
}

/// Takes what comes first, so that it is seen at once where one of the others ends.
void ForkedTeam::receive_of_all(std::vector<std::string>& all) {
  std::vector<pollfd> awaited;
  for (const Other& other : others_) awaited.push_back({other.connection, POLLIN, 0});
  for (std::size_t left = others_.size(); left > 0;) {
    if (::poll(awaited.data(), awaited.size(), -1) < 0) {
      require(errno == EINTR, others_.front());
      continue;
    }
    for (std::size_t i = 0; i < awaited.size(); ++i) {
      if (awaited[i].revents == 0) continue;
      require(receive_text(others_[i].connection, all[i + 1]), others_[i]);
      awaited[i].fd = -1;  // which poll passes over
      --left;
    }
  }
}

std::vector<std::string> ForkedTeam::exchange(const std::string& own) {
  if (loss_) throw *loss_;
  // Until all is said and heard: what ends it halfway is no Error of ours.
  loss_ = Error(
      "the processes of this run lost each other where the memory is short; give fewer processes, or fewer "
      "flights at a time");
  std::vector<std::string> all(size_);
  if (rank_ > 0) {
    const Other& first = others_.front();
    require(send_text(first.connection, own), first);
    for (std::string& each : all) require(receive_text(first.connection, each), first);
  } else {
    all.front() = own;
    receive_of_all(all);
    for (const Other& other : others_)
      for (const std::string& each : all) require(send_text(other.connection, each), other);
  }
  loss_.reset();
  return all;
}

}  // namespace pcor
