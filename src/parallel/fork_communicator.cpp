#include <pcor/parallel/fork_communicator.hpp>

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

namespace internal {

/// A process and the descriptor by which this one talks to it.
struct PeerProcess {
  pid_t process = -1;
  int connection = -1;
};

}  // namespace internal

using namespace internal;

namespace {

/// Repeats `move`, which sends or receives bytes, until it has moved all.
template <class Byte, class Move>
bool move_all(Byte* bytes, std::size_t count, const Move& move) {
  while (count > 0) {
    const ssize_t moved = move(bytes, count);
    if (moved < 0 && errno == EINTR) continue;
    if (moved <= 0) {
      if (moved == 0 || errno == EPIPE || errno == ECONNRESET) errno = 0;
      return false;
    }
    bytes += moved;
    count -= static_cast<std::size_t>(moved);
  }
  return true;
}

// Send and receive complete texts. On failure they return false; errno is 0 if the other process has ended.

bool send_text(int connection, const std::string& text) {
  const auto send = [connection](const char* bytes, std::size_t count) {
    return ::send(connection, bytes, count, MSG_NOSIGNAL);
  };
  const std::uint64_t count = text.size();
  return move_all(reinterpret_cast<const char*>(&count), sizeof count, send) &&
         move_all(text.data(), text.size(), send);
}

bool receive_text(int connection, std::string& text) {
  const auto receive = [connection](char* bytes, std::size_t count) {
    return ::recv(connection, bytes, count, 0);
  };
  std::uint64_t count = 0;
  if (!move_all(reinterpret_cast<char*>(&count), sizeof count, receive)) return false;
  text.resize(count);
  return move_all(text.data(), text.size(), receive);
}

/// Exit status of the process, as from waitpid; nullopt if the system no longer has it.
std::optional<int> end_of(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0)
    if (errno != EINTR) return std::nullopt;
  return status;
}

}  // namespace

ForkCommunicator::ForkCommunicator(std::size_t size) : size_(size) {
  const pid_t first = ::getpid();
  for (std::size_t rank = 1; rank < size; ++rank) {
    int ends[2] = {-1, -1};
    const bool is_connected = ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) == 0;
    const pid_t process = is_connected ? ::fork() : -1;
    if (process < 0) {
      const std::string why = std::strerror(errno);
      for (const int end : ends) ::close(end);
      let_go(true);
      throw Error(Error::Code::system,
                  fmt::format("cannot start {} processes ({}); use a smaller --processes", size, why));
    }
    if (process > 0) {
      ::close(ends[1]);
      others_.push_back({process, ends[0]});
      continue;
    }
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);  // if the first process ends before this one
    if (::getppid() != first) ::_exit(1);
    ::close(ends[0]);
    for (const PeerProcess& earlier : others_) ::close(earlier.connection);
    rank_ = rank;
    others_ = {{first, ends[1]}};
    return;
  }
}

ForkCommunicator::~ForkCommunicator() { let_go(loss_.has_value()); }

/// @param at_once the copies end where they are, and not with the work
void ForkCommunicator::let_go(bool at_once) {
  for (const PeerProcess& other : others_) ::close(other.connection);
  for (const PeerProcess& other : others_) {
    if (rank_ > 0) continue;
    if (at_once) ::kill(other.process, SIGTERM);
    end_of(other.process);
  }
  others_.clear();
}

Error ForkCommunicator::loss_of(const PeerProcess& other, int why) const {
  constexpr const char* fewer = "give fewer processes, or fewer flights at a time";
  if (why != 0)
    return Error(Error::Code::system,
                 fmt::format("the {} processes of this run cannot reach each other: {}; {}", size_,
                             std::strerror(why), fewer));
  if (rank_ > 0) return Error(Error::Code::system, "the first process of this run has ended");
  const std::optional<int> end = end_of(other.process);
  if (end && WIFEXITED(*end) && WEXITSTATUS(*end) == has_told) return Error(Error::Code::system, "");
  const std::string which = fmt::format("one of the {} processes of this run ", size_);
  if (end && WIFSIGNALED(*end) && WTERMSIG(*end) != SIGKILL)
    return Error(
        Error::Code::system,
        fmt::format(
            "{}was ended by the signal \"{}\"; run the command again; if this happens again, report it",
            which, ::strsignal(WTERMSIG(*end))));
  const bool is_killed = end && WIFSIGNALED(*end);
  return Error(Error::Code::system,
               fmt::format("{}, possibly because of too little memory; {}",
                           which + (is_killed ? "was killed" : "ended before the others"), fewer));
}

void ForkCommunicator::require(bool is_done, const PeerProcess& other) {
  if (is_done) return;
  loss_ = loss_of(other, errno);
  throw *loss_;
}

/// Takes what comes first, so that it is seen at once where one of the others ends.
void ForkCommunicator::receive_of_all(std::vector<std::string>& all) {
  std::vector<pollfd> awaited;
  for (const PeerProcess& other : others_) awaited.push_back({other.connection, POLLIN, 0});
  for (std::size_t left = others_.size(); left > 0;) {
    if (::poll(awaited.data(), awaited.size(), -1) < 0) {
      require(errno == EINTR, others_.front());
      continue;
    }
    for (std::size_t i = 0; i < awaited.size(); ++i) {
      if (awaited[i].revents == 0) continue;
      require(receive_text(others_[i].connection, all[i + 1]), others_[i]);
      awaited[i].fd = -1;  // poll ignores it
      --left;
    }
  }
}

std::vector<std::string> ForkCommunicator::exchange(const std::string& own) {
  if (loss_) throw *loss_;
  // Until all messages are sent and received: an interruption is not an Error of this process.
  loss_ = Error(Error::Code::system,
                "the processes of this run lost their connection, possibly because of too little memory; "
                "give fewer processes, or fewer flights at a time");
  std::vector<std::string> all(size_);
  if (rank_ > 0) {
    const PeerProcess& first = others_.front();
    require(send_text(first.connection, own), first);
    for (std::string& each : all) require(receive_text(first.connection, each), first);
  } else {
    all.front() = own;
    receive_of_all(all);
    for (const PeerProcess& other : others_)
      for (const std::string& each : all) require(send_text(other.connection, each), other);
  }
  loss_.reset();
  return all;
}

}  // namespace pcor
