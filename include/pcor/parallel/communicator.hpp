#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>

namespace pcor {

namespace internal {
struct Message;
}

/// Processes, or threads, that do one work together. All members run the same program on the same arguments,
/// each looks at some of the flights, and what they made of them is gathered on all: so every member comes to
/// the same result, which is that of one member alone, bit by bit, on processors of one kind.
///
/// A class derived from it says how bytes are exchanged: `ForkCommunicator`, and `MpiCommunicator` of
/// `pcor_mpi`. Members of a team call the same functions of it in the same order, each from one thread.
class Communicator {
 public:
  Communicator() = default;
  virtual ~Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  virtual std::size_t rank() const = 0;  ///< of this member, from 0
  virtual std::size_t size() const = 0;  ///< members, at least 1

  /// What every member has, in the order of ranks: one exchange.
  ///
  /// @param state in which the members have to agree, such as a digest of the coefficients and of the place
  ///        in the work
  /// @throws Error the error that members failed with here instead: of the lowest place, then of the lowest
  ///         rank. Error if the members are in different states.
  std::vector<std::string> gather(const std::string& own, std::uint64_t state = 0);

  /// Fails where the others gather, and throws there what they throw; after that the members may go on.
  /// @param place in which one member alone would come to the error: 0 before any flight, then by flight
  [[noreturn]] void fail(const Error& error, std::size_t place);

  /// The last words of this member, whether its work succeeded or not, so that no other waits for it. After
  /// that, and after those of another member, nothing is gathered any more.
  /// @return the error that all of the team end with, or none
  std::optional<Error> leave(const std::optional<Error>& error = std::nullopt);

 private:
  /// Gives each member the bytes of all, in the order of ranks.
  virtual std::vector<std::string> exchange(const std::string& own) = 0;

  std::vector<internal::Message> talk(const internal::Message& own);

  bool has_parted_ = false;
  std::optional<Error> parted_with_{};
};

/// A team of one.
Communicator& serial_communicator();

}  // namespace pcor
