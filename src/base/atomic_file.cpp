#include <pcor/base/atomic_file.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <pcor/base/error.hpp>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <random>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace pcor {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& output, const std::string& what) {
  throw Error(Error::Code::output, output.string() + what);
}

// Where a symbolic link leads, also if nothing is there yet. A circle of links ends where it began.
fs::path behind_links(fs::path path) {
  constexpr int max_links = 40;
  std::error_code code;
  for (int i = 0; i < max_links && fs::is_symlink(path, code); ++i)
    path = path.parent_path() / fs::read_symlink(path, code);
  return path;
}

// Paths of the unfinished files, for a signal handler: memory is neither allocated nor freed.
struct Unfinished {
  enum State : int { free, changing, listed };

  std::atomic<int> state{free};
  char path[PATH_MAX] = {};
};
static_assert(std::atomic<int>::is_always_lock_free);

std::array<Unfinished, 128> unfinished_files;

// One that finds no room is not listed; only a signal would leave it behind.
void list_as_unfinished(const std::string& path) {
  if (path.size() >= sizeof Unfinished::path) return;
  for (Unfinished& entry : unfinished_files) {
    int expected = Unfinished::free;
    if (!entry.state.compare_exchange_strong(expected, Unfinished::changing)) continue;
    std::memcpy(entry.path, path.c_str(), path.size() + 1);
    entry.state = Unfinished::listed;
    return;
  }
}

void take_from_list(const std::string& path) {
  for (Unfinished& entry : unfinished_files)
    if (entry.state == Unfinished::listed && path == entry.path) entry.state = Unfinished::free;
}

// Name of the set of processes in which a process number is unique: the host and its process namespace.
std::string neighbourhood() {
  char host[HOST_NAME_MAX + 1] = {};
  gethostname(host, HOST_NAME_MAX);
  struct stat space {};
  ::stat("/proc/self/ns/pid", &space);
  return std::string(host) + "-" + std::to_string(space.st_ino);
}

// Removes unfinished files of terminated processes of this neighbourhood from a folder. Processes of other
// hosts may still run.
void remove_stale_files(const fs::path& directory) {
  const std::string mark = "." + neighbourhood() + "-";
  std::error_code code;
  for (fs::directory_iterator entry(directory, code), end; !code && entry != end; entry.increment(code)) {
    const std::string name = entry->path().filename().string();
    const std::size_t at = name.rfind(mark);
    if (name.front() != '.' || at == std::string::npos || entry->path().extension() != ".part") continue;
    const long process = std::strtol(name.c_str() + at + mark.size(), nullptr, 10);
    std::error_code ignored;
    if (process > 0 && ::kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH)
      fs::remove(entry->path(), ignored);
  }
}

// Creates a file ".NAME.HOST-SPACE-PROCESS.XXXXXX.part" that no other program uses, including programs on
// other hosts and killed ones. Unlike with mkstemp it has the permissions of any new file. It is listed
// before it is created, so a signal handler finds it at any time. Returns an empty path on failure, with the
// reason in errno.
fs::path make_hidden_file(const fs::path& directory, const std::string& name) {
  constexpr const char* letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
  const std::string writer = "." + neighbourhood() + "-" + std::to_string(getpid()) + ".";
  const std::size_t most_of_name = NAME_MAX - std::string_view(".XXXXXX.part").size() - writer.size();
  constexpr int tries = 100;
  std::random_device random;
  std::uniform_int_distribution<std::size_t> letter(0, std::strlen(letters) - 1);
  for (int i = 0; i < tries; ++i) {
    std::string chosen = "." + name.substr(0, most_of_name) + writer;
    for (int j = 0; j < 6; ++j) chosen += letters[letter(random)];
    fs::path path = directory / (chosen + ".part");
    list_as_unfinished(path.string());
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0) {
      ::close(file);
      return path;
    }
    const int reason = errno;
    take_from_list(path.string());
    errno = reason;
    if (reason != EEXIST) break;
  }
  return {};
}

// Flushes the written data to disk; on failure returns false with the reason in errno.
bool settle(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool settled = ::fsync(file) == 0;
  const int reason = errno;
  ::close(file);
  errno = reason;
  return settled;
}

void put_in_place(const fs::path& shown, const fs::path& target, const fs::path& path) {
  std::error_code code;
  fs::rename(path, target, code);
  if (code) fail(shown, " cannot be put in place: " + code.message() + "; choose another output");
  take_from_list(path.string());
}

// While one lives, no signal ends the program in this thread.
class SignalsWait {
 public:
  SignalsWait() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~SignalsWait() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

  SignalsWait(const SignalsWait&) = delete;
  SignalsWait& operator=(const SignalsWait&) = delete;

 private:
  sigset_t before_{};
};

constexpr const char* advice = "; check the space and the permissions there, or choose another output";

OutputTransaction* outputs_together = nullptr;

}  // namespace

void remove_unfinished_files() noexcept {
  const int before = errno;
  for (const Unfinished& entry : unfinished_files)
    if (entry.state == Unfinished::listed) ::unlink(entry.path);
  errno = before;
}

AtomicFile::AtomicFile(const fs::path& target) : shown_(target) {
  if (target.empty()) fail("", "the output has no name; name a file");
  std::error_code code;
  target_ = fs::weakly_canonical(behind_links(fs::absolute(target)), code);
  if (code) fail(shown_, " cannot be written: " + code.message() + "; choose another output");
  const fs::file_status status = fs::status(target_, code);
  if (fs::is_directory(status)) fail(shown_, " is a directory; name a file");
  if (fs::exists(status) && !fs::is_regular_file(status))
    fail(shown_, " is not a regular file; choose another output");
  const fs::path directory = target_.parent_path();
  if (!fs::is_directory(directory, code))
    fail(shown_, " cannot be written: there is no directory " + directory.string() + "; make it first");
  const auto cannot_write = [&] {
    return " cannot be written: " + directory.string() + ": " + std::strerror(errno);
  };
  if (access(directory.c_str(), W_OK | X_OK) != 0) fail(shown_, cannot_write() + "; choose another output");
  remove_stale_files(directory);
  path_ = make_hidden_file(directory, target_.filename().string());
  if (path_.empty()) fail(shown_, cannot_write() + advice);
}

AtomicFile::~AtomicFile() {
  if (committed_) return;
  std::error_code ignored;
  // HDF5 keeps a file open that it could not complete: truncating it first releases the disk space anyway.
  fs::resize_file(path_, 0, ignored);
  fs::remove(path_, ignored);
  take_from_list(path_.string());
}

void AtomicFile::write(std::string_view text) {
  std::ofstream stream(path_, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream)
    fail(shown_, " cannot be written: check the space and the permissions there, or choose another output");
  commit();
}

void AtomicFile::commit() {
  std::error_code code;
  if (fs::exists(target_, code)) fs::permissions(path_, fs::status(target_).permissions(), code);
  if (!settle(path_)) fail(shown_, std::string(" cannot be written: ") + std::strerror(errno) + advice);
  if (outputs_together != nullptr) {
    outputs_together->waiting_.push_back({shown_, target_, path_});
  } else {
    put_in_place(shown_, target_, path_);
  }
  committed_ = true;
}

OutputTransaction::OutputTransaction() : whole_(outputs_together != nullptr ? outputs_together : this) {
  outputs_together = whole_;
}

OutputTransaction::~OutputTransaction() {
  if (whole_ != this) return;
  outputs_together = nullptr;
  std::error_code ignored;
  for (const Waiting& file : waiting_) {
    fs::remove(file.path, ignored);
    take_from_list(file.path.string());
  }
}

fs::path readable_output(const fs::path& target) {
  if (outputs_together != nullptr) {
    for (const OutputTransaction::Waiting& file : outputs_together->waiting_)
      if (file.shown == target) return file.path;
  }
  return target;
}

void OutputTransaction::appear() {
  if (whole_ != this) return;
  // An open file keeps its space: to give back the space of a large file takes the time of many renames.
  std::vector<std::ifstream> replaced;
  for (const Waiting& file : waiting_) replaced.emplace_back(file.target);
  const SignalsWait signals_wait;
  while (!waiting_.empty()) {
    const Waiting& file = waiting_.front();
    put_in_place(file.shown, file.target, file.path);
    waiting_.erase(waiting_.begin());
  }
}

}  // namespace pcor
