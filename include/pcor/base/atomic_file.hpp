#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace pcor {

/// Atomic replacement of the file `target`: write to `path()`, an empty hidden file in the same directory,
/// then `commit`. The hidden name contains host and process id, so that the next process of that host removes
/// files of killed processes in the directory.
class AtomicFile {
 public:
  /// @throws Error if the target's directory is absent or not writable, or the target is not a regular file
  /// (a directory, a device). A symbolic link is followed.
  explicit AtomicFile(const std::filesystem::path& target);

  /// Removes the file unless it was committed.
  ~AtomicFile();

  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Writes the whole text and commits. @throws Error if impossible.
  void write(std::string_view text);

  /// Synchronises the file to disk and renames it to the target, with the permissions of the file it
  /// replaces; during an `OutputTransaction`, the rename is deferred. @throws Error if impossible.
  void commit();

 private:
  std::filesystem::path shown_, target_, path_;
  bool committed_ = false;
};

/// Transaction of output files. Committed files are complete on disk and wait in the directories of their
/// targets. They are renamed in immediate succession with signals blocked, or all discarded if the
/// transaction ends first; only a SIGKILL or a system failure between two renames can separate them. For the
/// files of one thread; a nested transaction is part of the outer one.
class OutputTransaction {
 public:
  OutputTransaction();
  ~OutputTransaction();

  OutputTransaction(const OutputTransaction&) = delete;
  OutputTransaction& operator=(const OutputTransaction&) = delete;

  /// Renames all waiting files to their targets. @throws Error if a rename fails; earlier ones remain.
  void appear();

 private:
  friend class AtomicFile;
  friend std::filesystem::path readable_output(const std::filesystem::path& target);

  struct Waiting {
    std::filesystem::path shown, target, path;
  };
  OutputTransaction* whole_;  // the outermost transaction: itself or its parent
  std::vector<Waiting> waiting_;
};

/// Path at which a file committed to `target` can be read: the target, or its hidden file during a
/// transaction.
std::filesystem::path readable_output(const std::filesystem::path& target);

/// Removes at most 128 unfinished files of this process; for a signal handler that then ends the process, as
/// SIGINT would.
void remove_unfinished_files() noexcept;

}  // namespace pcor
