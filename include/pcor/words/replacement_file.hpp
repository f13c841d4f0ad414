#pragma once

#include <filesystem>

namespace pcor {

/// A file that appears at `target` whole or not at all: write to `path()`, a hidden file beside it that is
/// there and empty, then `commit`.
class ReplacementFile {
 public:
  /// @throws Error if the target's directory is absent or not writable, or the target is something else than
  /// a regular file (a directory, a device). A symbolic link is followed.
  explicit ReplacementFile(const std::filesystem::path& target);

  /// Removes the file unless it was committed.
  ~ReplacementFile();

  ReplacementFile(const ReplacementFile&) = delete;
  ReplacementFile& operator=(const ReplacementFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Puts the file in the target's place once the disk holds it, with the permissions of what it replaces.
  /// @throws Error if impossible.
  void commit();

 private:
  std::filesystem::path shown_, target_, path_;
  bool committed_ = false;
};

/// Removes the hidden files of all that is being written in this process, at most 16; for a signal handler
/// that then ends the process, as SIGINT would: it only unlinks.
void remove_unfinished_files() noexcept;

}  // namespace pcor
