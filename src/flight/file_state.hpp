#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

namespace pcor::internal {

/// Which file a path names at a moment, and when it was last changed: two states differ if the file was
/// replaced or written to in between. A path without a file has the default state.
class FileState {
 public:
  FileState() = default;
  explicit FileState(const std::filesystem::path& path);

  bool operator==(const FileState& other) const { return facts_ == other.facts_; }
  bool operator!=(const FileState& other) const { return !(*this == other); }

  /// @throws Error unless the path still names this file, unchanged
  void require(const std::filesystem::path& path) const;

 private:
  // Device, inode, size in bytes, and the times in ns of the last modification and of the last change. A
  // program cannot set the time of change.
  std::array<std::int64_t, 5> facts_{};
};

}  // namespace pcor::internal
