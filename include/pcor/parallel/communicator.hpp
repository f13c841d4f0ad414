#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>

namespace pcor {

/// Group of processes or threads that work together. All ranks run the same program on the same arguments,
/// each processes some of the flights, and results are gathered on all ranks: every rank obtains the same
/// result, equal to that of a serial run bit by bit on identical processors.
///
/// This class is a group of one rank. A derived class implements the exchange of bytes: `MpiCommunicator` of
/// `pcor_mpi`. All ranks call the same functions in the same order, each from one thread.
class Communicator {
 public:
  Communicator() = default;
  virtual ~Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  // A group of several ranks overrides `rank`, `size` and `exchange`, all three.
  virtual std::size_t rank() const { return 0; }  ///< rank of this process, from 0
  virtual std::size_t size() const { return 1; }  ///< number of ranks, at least 1

  /// Gathers the values of all ranks on every rank, in the order of ranks: one collective exchange.
  ///
  /// @param state must be equal on all ranks, such as a digest of the coefficients and of the position in the
  /// work
  /// @throws Error if ranks called `fail` instead: the error of the lowest `order`, then of the lowest rank.
  /// Error if the ranks are in different states.
  std::vector<std::string> all_gather(const std::string& local, std::uint64_t state = 0);

  /// Fails while the other ranks gather; all throw the same error and may continue after it.
  /// @param order of the error in a serial run: 0 before any flight, then by flight
  [[noreturn]] void fail(const Error& error, std::size_t order);

  /// Last call of a rank, with or without an error, so that other ranks do not wait for it. No gather is
  /// possible after it, or after that of another rank.
  /// @return common error of all ranks, if any
  std::optional<Error> finalize(const std::optional<Error>& error = std::nullopt);

 private:
  struct Message;

  /// Gives each rank the bytes of all, in the order of ranks.
  virtual std::vector<std::string> exchange(const std::string& local) { return {local}; }

  std::vector<Message> talk(const Message& local);

  bool has_parted_ = false;
  std::optional<Error> parted_with_{};
};

/// Communicator of one rank.
Communicator& serial_communicator();

}  // namespace pcor
