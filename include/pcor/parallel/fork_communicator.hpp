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

/// Processes of one machine that share a work: the process that makes the team, of rank 0, and copies of it,
/// which go on from the same place with ranks of their own. They read at the same time, which threads of one
/// process cannot, as the netCDF library reads for one of them at a time.
///
/// Where a copy ends before the others, rank 0 throws the Error of that from its next exchange, and
/// the other copies get SIGTERM; so they do where rank 0 ends. The caller must not ignore SIGCHLD: the system
/// would forget how copies ended.
class ForkCommunicator final : public Communicator {
 public:
  /// The status with which a copy ends that has told the user why it does: of that loss rank 0 throws an
  /// Error without a text.
  static constexpr int has_told = 3;

  /// To be made while the process has one thread and no open flight.
  /// @param size processes, at least 1
  /// @throws Error if the system begins no more processes
  explicit ForkCommunicator(std::size_t size);

  /// Of rank 0: waits for the copies to end.
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
  std::vector<internal::PeerProcess> others_;  // of rank 0 all others, in the order of ranks; of these rank 0
  std::optional<Error> loss_{};                // after which nothing is exchanged any more
};

}  // namespace pcor
