#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

namespace pcor::internal {

/// A process and the descriptor by which this one talks to it.
struct PeerProcess {
  int process = -1;     ///< its number
  int connection = -1;  ///< closed by the caller
};

/// Result of a fork: the child in the parent process, the parent in the child process.
struct ForkedProcess {
  PeerProcess other{};
  bool is_copy = false;
};

/// Forks this process. The process must have one thread. Both sides must close the connection, and the parent
/// must wait for the child (`end_of`).
///
/// @param when_alone signal sent to the child if the parent ends first
/// @return nullopt if the system starts no more processes, with the reason in errno
std::optional<ForkedProcess> fork_process(int when_alone);

/// Send and receive complete texts. On failure they return false; errno is 0 if the other process has ended.
/// @param maximum maximum accepted length of a text, characters
bool send_text(int connection, const std::string& text);
bool receive_text(int connection, std::string& text,
                  std::uint64_t maximum = std::numeric_limits<std::uint64_t>::max());

/// Exit status of the process, as from waitpid; nullopt if the system no longer has it.
std::optional<int> end_of(int process);

}  // namespace pcor::internal
