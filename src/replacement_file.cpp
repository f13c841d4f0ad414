#include <pcor/offline/replacement_file.hpp>

#include <unistd.h>
#include <pcor/offline/error.hpp>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

namespace pcor {

namespace fs = std::filesystem;

namespace {

// Where a symbolic link leads, also if nothing is there yet. A circle of links ends where it began.
fs::path behind_links(fs::path path) {
  constexpr int most_links = 40;
  std::error_code code;
  for (int i = 0; i < most_links && fs::is_symlink(path, code); ++i)
    path = path.parent_path() / fs::read_symlink(path, code);
  return path;
}

}  // namespace

ReplacementFile::ReplacementFile(const fs::path& target) : shown_(target) {
  if (target.empty()) throw Error("the output has no name; name a file");
  std::error_code code;
  target_ = fs::weakly_canonical(behind_links(fs::absolute(target)), code);
  if (code)
    throw Error(shown_.string() + " cannot be written: " + code.message() + "; choose another output");
  const fs::file_status status = fs::status(target_, code);
  if (fs::is_directory(status)) throw Error(shown_.string() + " is a directory; name a file");
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw Error(shown_.string() + " is not a regular file; choose another output");
  const fs::path directory = target_.parent_path();
  if (!fs::is_directory(directory, code))
    throw Error(shown_.string() + " cannot be written: there is no directory " + directory.string() +
                "; make it first");
  if (access(directory.c_str(), W_OK | X_OK) != 0)
    throw Error(shown_.string() + " cannot be written: " + directory.string() + ": " + std::strerror(errno) +
                "; choose another output");
  static std::atomic<unsigned> number{0};
  path_ = directory / (".pcor-" + std::to_string(getpid()) + "-" + std::to_string(++number) + ".part");
}

ReplacementFile::~ReplacementFile() {
  if (committed_) return;
  std::error_code ignored;
  // HDF5 keeps a file open that it could not complete: emptied first, it gives its space back all the same.
  fs::resize_file(path_, 0, ignored);
  fs::remove(path_, ignored);
}

void ReplacementFile::commit() {
  std::error_code code;
  if (fs::exists(target_, code)) fs::permissions(path_, fs::status(target_).permissions(), code);
  fs::rename(path_, target_, code);
  if (code)
    throw Error(shown_.string() + " cannot be put in place: " + code.message() + "; choose another output");
  committed_ = true;
}

}  // namespace pcor
