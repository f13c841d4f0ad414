#pragma once

#include <pcor/team/team.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace pcor {

/// Processes of one machine that share a work: the process that makes the team, of rank 0, and copies of it,
/// which go on from the same place with ranks of their own. Each has its own netCDF library, which reads for
/// one thread of a process at a time.
///
/// Where a copy ends, rank 0 fails with the next exchange; where rank 0 ends, the copies get SIGTERM. At the
/// end of its life the team of rank 0 waits for the copies to end; what they end with is not looked at any
/// more.
class ForkedTeam final : public Team {
 public:
  /// To be made while the process has one thread and no open flight.
  /// @param size processes, at least 1
  /// @throws Error if the system begins no more processes
  explicit ForkedTeam(std::size_t size);
  ~ForkedTeam() override;

  std::size_t rank() const override { return rank_; }
  std::size_t size() const override { return size_; }

 private:
  /// @throws Error if another process has ended; one without a text if that has said why.
  std::vector<std::string> exchange(const std::string& own) override;

  /// The end of a connection with another process.
  class Connection {
   public:
    Connection(int descriptor, int process) : descriptor_(descriptor), process_(process) {}
    Connection(Connection&& other) noexcept;
    Connection& operator=(Connection&&) = delete;
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;
    ~Connection();

    /// False where the other process is gone.
    bool send(const std::string& bytes) const;
    bool receive(std::string& bytes) const;

    int process() const { return process_; }

   private:
    int descriptor_;
    int process_;
  };

  Error loss_of(const Connection& other) const;

  std::size_t rank_ = 0;
  std::size_t size_ = 1;
  std::vector<Connection> others_{};  // of rank 0 all others, in the order of ranks; of these rank 0
  std::optional<Error> loss_{};       // after which nothing is exchanged any more
};

}  // namespace pcor
