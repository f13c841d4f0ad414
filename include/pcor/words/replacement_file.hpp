#pragma once

#include <filesystem>
#include <vector>

namespace pcor {

/// A file that appears at `target` whole or not at all: write to `path()`, a hidden file beside it that is
/// there and empty, then `commit`. The hidden name has in it those of the host and the process, so that what
/// a killed process left behind is known: the next one of that host in that folder removes it.
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

  /// Puts the file in the target's place once the disk holds it, with the permissions of what it replaces;
  /// while an `OutputsTogether` lives, when that lets it appear. @throws Error if impossible.
  void commit();

 private:
  std::filesystem::path shown_, target_, path_;
  bool committed_ = false;
};

/// While one lives, files that are committed wait beside their targets, whole and on the disk. They appear
/// together, one right after the other; none does if it goes before. There is one at a time, and it is for
/// the files of one thread.
class OutputsTogether {
 public:
  OutputsTogether();
  ~OutputsTogether();

  OutputsTogether(const OutputsTogether&) = delete;
  OutputsTogether& operator=(const OutputsTogether&) = delete;

  /// Whether one lives.
  static bool is_there();

  /// @throws Error if a file cannot be put in its place; those before it are.
  void appear();

 private:
  friend class ReplacementFile;
  friend std::filesystem::path readable_output(const std::filesystem::path& target);

  struct Waiting {
    std::filesystem::path shown, target, path;
  };
  std::vector<Waiting> waiting_;
};

/// Where a file that was committed to `target` can be read: there, or beside it while it waits for others.
std::filesystem::path readable_output(const std::filesystem::path& target);

/// Removes the hidden files of all that is being written in this process, at most 16; for a signal handler
/// that then ends the process, as SIGINT would: it only unlinks.
void remove_unfinished_files() noexcept;

}  // namespace pcor
