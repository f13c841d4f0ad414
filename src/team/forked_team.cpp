#include <pcor/team/forked_team.hpp>

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

namespace pcor {
namespace {

bool send_all(int descriptor, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t sent = ::send(descriptor, bytes, count, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    bytes += sent;
    count -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool receive_all(int descriptor, char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t received = ::recv(descriptor, bytes, count, 0);
    if (received < 0 && errno == EINTR) continue;
    if (received <= 0) return false;
    bytes += received;
    count -= static_cast<std::size_t>(received);
  }
  return true;
}

}  // namespace

ForkedTeam::Connection::Connection(Connection&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), process_(other.process_) {}

ForkedTeam::Connection::~Connection() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool ForkedTeam::Connection::send(const std::string& bytes) const {
  const std::uint64_t count = bytes.size();
  return send_all(descriptor_, reinterpret_cast<const char*>(&count), sizeof count) &&
         send_all(descriptor_, bytes.data(), bytes.size());
}

bool ForkedTeam::Connection::receive(std::string& bytes) const {
  std::uint64_t count = 0;
  if (!receive_all(descriptor_, reinterpret_cast<char*>(&count), sizeof count)) return false;
  bytes.resize(count);
  return receive_all(descriptor_, bytes.data(), bytes.size());
}

ForkedTeam::ForkedTeam(std::size_t size) : size_(size) {
  const pid_t first = ::getpid();
  for (std::size_t rank = 1; rank < size; ++rank) {
    int ends[2];
    const bool is_connected = ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) == 0;
    const pid_t process = is_connected ? ::fork() : -1;
    if (process < 0) {
      const std::string why = std::strerror(errno);
      if (is_connected) ::close(ends[0]), ::close(ends[1]);
      throw Error(fmt::format("{} processes cannot be begun: {}; ask for fewer", size, why));
    }
    if (process == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGTERM);
      if (::getppid() != first) ::_exit(1);
      rank_ = rank;
      others_.clear();
      ::close(ends[0]);
      others_.emplace_back(ends[1], first);
      return;
    }
    ::close(ends[1]);
    others_.emplace_back(ends[0], process);
  }
}

ForkedTeam::~ForkedTeam() {
  if (rank_ > 0) return;
  std::vector<int> processes;
  for (const Connection& each : others_) processes.push_back(each.process());
  others_.clear();  // who still waits for this process ends
  for (const int process : processes)
    while (::waitpid(process, nullptr, 0) < 0 && errno == EINTR) {
    }
}

Error ForkedTeam::loss_of(const Connection& other) const {
  if (rank_ > 0) return Error("the first process of this run has ended");
  int status = 0;
  const bool is_known = ::waitpid(other.process(), &status, 0) == other.process();
  if (is_known && !WIFSIGNALED(status)) return Error("");
  const std::string how = is_known ? fmt::format(" by the signal \"{}\"", ::strsignal(WTERMSIG(status))) : "";
  return Error(
      fmt::format("one of the {} processes of this run was ended{}, as the system does where the memory is "
                  "short; give fewer processes, or fewer flights at a time",
                  size_, how));
}

std::vector<std::string> ForkedTeam::exchange(const std::string& own) {
  if (loss_) throw *loss_;
  loss_ = Error(
      "the processes of this run could not go on with each other, as where the memory is short; give fewer "
      "processes, or "
      "fewer flights at a time");
  std::vector<std::string> all(size_);
  const auto require = [this](bool is_done, const Connection& other) {
    if (is_done) return;
    loss_ = loss_of(other);
    throw *loss_;
  };
  if (rank_ > 0) {
    const Connection& first = others_.front();
    require(first.send(own), first);
    for (std::string& each : all) require(first.receive(each), first);
  } else {
    all.front() = own;
    for (std::size_t i = 0; i < others_.size(); ++i) require(others_[i].receive(all[i + 1]), others_[i]);
    for (const Connection& other : others_)
      for (const std::string& each : all) require(other.send(each), other);
  }
  loss_.reset();
  return all;
}

}  // namespace pcor
