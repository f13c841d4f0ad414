#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>

namespace pcor::internal {

/// Which file a path names at a moment, and when it was last changed: two states differ if the file was
/// replaced or written to in between. A path without a file has the default state.
class FileState {
 public:
  FileState() = default;
  explicit FileState(const std::filesystem::path& path);

  bool operator==(const FileState& other) const;
  bool operator!=(const FileState& other) const { return !(*this == other); }

  /// @throws Error unless the path still names this file, unchanged
  void require(const std::filesystem::path& path) const;

 private:
  dev_t device_ = 0;
  ino_t inode_ = 0;
  off_t size_ = 0;
  std::int64_t modified_ = 0;  // ns
  std::int64_t changed_ = 0;   // ns; a program cannot set it, unlike the time of modification
};

}  // namespace pcor::internal
