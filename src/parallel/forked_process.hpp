#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

namespace pcor::internal {

/// A process and the descriptor by which this one talks to it.
struct PeerProcess {
  int process = -1;     ///< its number
  int connection = -1;  ///< to be closed by who made it
};

/// What comes of a copy: in the process that makes it the copy, in the copy the process that it is of.
struct ForkedProcess {
  PeerProcess other{};
  bool is_copy = false;
};

/// Makes a copy of this process, which goes on from the same place. To be called while it has one thread.
/// Both have to close the connection, and the first to wait for the copy (`end_of`). A copy that is not to do
/// what is left to be done at the exit ends by `_exit`.
///
/// @param when_alone the signal that the copy gets where this process ends before it
/// @return nothing where the system begins no more processes, and errno says why
std::optional<ForkedProcess> fork_process(int when_alone);

/// Sends and receives whole texts. False where that fails; errno is 0 then where the other process has ended.
/// @param most letters that are believed of a text
bool send_text(int connection, const std::string& text);
bool receive_text(int connection, std::string& text,
                  std::uint64_t most = std::numeric_limits<std::uint64_t>::max());

/// What the process ended with, as waitpid has it; nothing where the system has forgotten it.
std::optional<int> end_of(int process);

}  // namespace pcor::internal
