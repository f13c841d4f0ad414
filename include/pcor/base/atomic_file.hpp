#pragma once

#include <filesystem>
#include <vector>

namespace pcor {

/// A file that appears at `target` whole or not at all: write to `path()`, a hidden file beside it that is
/// there and empty, then `commit`. The hidden name has in it those of the host and the process, so that what
/// a killed process left behind is known: the next one of that host in that folder removes it.
class AtomicFile {
 public:
  /// @throws Error if the target's directory is absent or not writable, or the target is something else than
  /// a regular file (a directory, a device). A symbolic link is followed.
  explicit AtomicFile(const std::filesystem::path& target);

  /// Removes the file unless it was committed.
  ~AtomicFile();

  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Puts the file in the target's place once the disk holds it, with the permissions of what it replaces;
  /// while an `OutputTransaction` lives, when that lets it appear. @throws Error if impossible.
  void commit();

 private:
  std::filesystem::path shown_, target_, path_;
  bool committed_ = false;
};

/// While one lives, files that are committed wait beside their targets, whole and on the disk. They appear
/// together: one right after the other, while signals wait; none does if it goes before. So only a SIGKILL or
/// a failure of the machine within the microseconds between can part them. It is for the files of one thread;
/// one that is made while another lives is a part of that.
class OutputTransaction {
 public:
  OutputTransaction();
  ~OutputTransaction();

  OutputTransaction(const OutputTransaction&) = delete;
  OutputTransaction& operator=(const OutputTransaction&) = delete;

  /// Makes a folder for outputs, and those above it. What is new of them goes again if nothing appears, also
  /// where a signal ends the program. @throws Error if it cannot be there.
  void make_folder(const std::filesystem::path& folder);

  /// Has a file of an earlier run go when the outputs have appeared.
  void remove(const std::filesystem::path& earlier);

  /// @throws Error if a file cannot be put in its place; those before it are.
  void appear();

 private:
  friend class AtomicFile;
  friend std::filesystem::path readable_output(const std::filesystem::path& target);

  struct Waiting {
    std::filesystem::path shown, target, path;
  };
  OutputTransaction* whole_;  // itself, or the one that it is a part of
  std::vector<Waiting> waiting_;
  std::vector<std::filesystem::path> folders_;  // that were made, each behind the one that it is in
  std::vector<std::filesystem::path> earlier_;
};

/// Where a file that was committed to `target` can be read: there, or beside it while it waits for
/// others.
std::filesystem::path readable_output(const std::filesystem::path& target);

/// Removes the hidden files of all that is being written in this process, at most 128, and the
/// folders that were made for them; for a signal handler that then ends the process, as SIGINT would.
void remove_unfinished_files() noexcept;

}  // namespace pcor
