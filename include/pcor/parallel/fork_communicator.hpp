#pragma once

#include <pcor/parallel/communicator.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace pcor {

namespace internal {
struct PeerProcess;
}

/// Processes of one machine that share a computation: the creating process, rank 0, and its forked children
/// with the other ranks. They read in parallel, which threads of one process cannot, because the netCDF
/// library is serial.
///
/// If a child ends before the others, rank 0 throws its Error at the next exchange, and the other children
/// receive SIGTERM, as they do if rank 0 ends. The caller must not ignore SIGCHLD; otherwise exit statuses
/// are lost.
class ForkCommunicator final : public Communicator {
 public:
  /// Exit status of a child that has already printed its error: rank 0 then throws an Error without text.
  static constexpr int has_told = 3;

  /// Must be created while the process has one thread and no open flight.
  /// @param size processes, at least 1
  /// @throws Error if the system cannot create the processes
  explicit ForkCommunicator(std::size_t size);

  /// Rank 0: waits for the children to end.
  ~ForkCommunicator() override;

  std::size_t rank() const override { return rank_; }
  std::size_t size() const override { return size_; }

 private:
  std::vector<std::string> exchange(const std::string& own) override;

  void receive_of_all(std::vector<std::string>& all);
  void require(bool is_done, const internal::PeerProcess& other);
  Error loss_of(const internal::PeerProcess& other, int why) const;
  void let_go(bool at_once);

  std::size_t rank_ = 0;
  std::size_t size_ = 1;
  std::vector<internal::PeerProcess> others_;  // rank 0: all other ranks in order; otherwise: rank 0
  std::optional<Error> loss_{};                // no exchange is possible after it
};

}  // namespace pcor
