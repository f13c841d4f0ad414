#include <pcor/parallel/fork_communicator.hpp>

#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

#include "parallel/forked_process.hpp"

namespace pcor {

using namespace internal;

ForkCommunicator::ForkCommunicator(std::size_t size) : size_(size) {
  for (std::size_t rank = 1; rank < size; ++rank) {
    const std::optional<ForkedProcess> copied = fork_process(SIGTERM);
    if (!copied) {
      const std::string why = std::strerror(errno);
      let_go(true);
      throw Error(Error::Code::system,
                  fmt::format("cannot start {} processes ({}); use a smaller --processes", size, why));
    }
    if (!copied->is_copy) {
      others_.push_back(copied->other);
      continue;
    }
    for (const PeerProcess& earlier : others_) ::close(earlier.connection);
    rank_ = rank;
    others_ = {copied->other};
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
