#include "flight/file_state.hpp"

#include <sys/stat.h>

#include <pcor/base/error.hpp>

namespace pcor::internal {
FileState::FileState(const std::filesystem::path& path) {
  const auto nanoseconds = [](const timespec& time) {
    return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
  };
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return;
  facts_ = {static_cast<std::int64_t>(info.st_dev), static_cast<std::int64_t>(info.st_ino), info.st_size,
            nanoseconds(info.st_mtim), nanoseconds(info.st_ctim)};
}

void FileState::require(const std::filesystem::path& path) const {
  if (FileState(path) == *this) return;
  throw Error(Error::Code::file,
              path.string() + " was replaced or changed while it was read; retry when the file is complete");
}

}  // namespace pcor::internal
