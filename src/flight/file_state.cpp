#include "flight/file_state.hpp"

#include <sys/stat.h>

#include <tuple>

#include <pcor/base/error.hpp>

namespace pcor::internal {
namespace {

std::int64_t nanoseconds(const timespec& time) {
  return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

}  // namespace

FileState::FileState(const std::filesystem::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return;
  device_ = info.st_dev;
  inode_ = info.st_ino;
  size_ = info.st_size;
  modified_ = nanoseconds(info.st_mtim);
  changed_ = nanoseconds(info.st_ctim);
}

bool FileState::operator==(const FileState& other) const {
  const auto all = [](const FileState& state) {
    return std::tie(state.device_, state.inode_, state.size_, state.modified_, state.changed_);
  };
  return all(*this) == all(other);
}

void FileState::require(const std::filesystem::path& path) const {
  if (FileState(path) == *this) return;
  throw Error(Error::Code::file,
              path.string() + " was replaced or changed while it was read; retry when the file is complete");
}

}  // namespace pcor::internal
