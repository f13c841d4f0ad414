/// Makes one system call of a program fail. The library is preloaded:
///
///     LD_PRELOAD=libfailing_calls.so FAILING_CALL=write FAILING_NUMBER=3 FAILING_REPORT=report PROGRAM ...
///
/// The third call of the kind `write` after the start of `main` fails as on a full disk; the kinds are listed
/// below. With the kind "stop" no call fails, but the program gets SIGTERM before its third rename. The name
/// of the failed call is written to the report; there is no report if the program makes fewer calls.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming): names of the C library
extern "C" {
// Internal names of C library functions. dlsym cannot be used for them, because it allocates memory.
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* memory, std::size_t bytes);
}
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)

namespace {

/// Calls that are counted together, and the errno of a failure.
struct Kind {
  const char* name;
  int reason;
};

constexpr Kind memory{"memory", ENOMEM};
constexpr Kind opening{"open", EMFILE};
constexpr Kind reading{"read", EIO};
constexpr Kind writing{"write", ENOSPC};
constexpr Kind syncing{"sync", EIO};
constexpr Kind renaming{"rename", EACCES};
constexpr Kind closing{"close", EIO};
constexpr Kind stopping{"stop", 0};

const char* failing_kind = nullptr;  // null before main
std::atomic<long> remaining_calls{0};

void report(const char* call) {
  const auto file = static_cast<int>(
      ::syscall(SYS_openat, AT_FDCWD, std::getenv("FAILING_REPORT"), O_WRONLY | O_CREAT | O_TRUNC, 0666));
  ::syscall(SYS_write, file, call, std::strlen(call));
  ::syscall(SYS_close, file);
}

/// True if this call must fail; sets errno.
bool fails(const Kind& kind, const char* call) {
  if (failing_kind == nullptr || std::strcmp(kind.name, failing_kind) != 0 || --remaining_calls != 0)
    return false;
  report(call);
  errno = kind.reason;
  return true;
}

/// Original function of the given name.
template <class Function>
Function* real(Function* /*replacement*/, const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

using Main = int(int, char**, char**);
Main* program = nullptr;

int count_from_here(int argc, char** argv, char** environment) {
  if (const char* const number = std::getenv("FAILING_NUMBER")) remaining_calls = std::atol(number);
  failing_kind = std::getenv("FAILING_CALL");
  return program(argc, argv, environment);
}

}  // namespace

extern "C" {

// NOLINTNEXTLINE(bugprone-reserved-identifier, readability-identifier-naming)
int __libc_start_main(Main* main, int argc, char** argv, Main* init, void (*fini)(), void (*linker)(),
                      void* stack) {
  program = main;
  return real(__libc_start_main, "__libc_start_main")(count_from_here, argc, argv, init, fini, linker, stack);
}

void* malloc(std::size_t bytes) { return fails(memory, "malloc") ? nullptr : __libc_malloc(bytes); }
void* calloc(std::size_t count, std::size_t bytes) {
  return fails(memory, "calloc") ? nullptr : __libc_calloc(count, bytes);
}
void* realloc(void* before, std::size_t bytes) {
  return fails(memory, "realloc") ? nullptr : __libc_realloc(before, bytes);
}

int open(const char* path, int flags, ...) {
  std::va_list rest;
  va_start(rest, flags);
  const mode_t mode = va_arg(rest, mode_t);
  va_end(rest);
  return fails(opening, path) ? -1 : real(open, "open")(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  std::va_list rest;
  va_start(rest, flags);
  const mode_t mode = va_arg(rest, mode_t);
  va_end(rest);
  return fails(opening, path) ? -1 : real(open64, "open64")(path, flags, mode);
}
std::FILE* fopen(const char* path, const char* mode) {
  return fails(opening, path) ? nullptr : real(fopen, "fopen")(path, mode);
}
std::FILE* fopen64(const char* path, const char* mode) {
  return fails(opening, path) ? nullptr : real(fopen64, "fopen64")(path, mode);
}

ssize_t read(int file, void* bytes, std::size_t count) {
  return fails(reading, "read") ? -1 : real(read, "read")(file, bytes, count);
}
ssize_t pread(int file, void* bytes, std::size_t count, off_t position) {
  return fails(reading, "pread") ? -1 : real(pread, "pread")(file, bytes, count, position);
}

ssize_t write(int file, const void* bytes, std::size_t count) {
  return fails(writing, "write") ? -1 : real(write, "write")(file, bytes, count);
}
ssize_t pwrite(int file, const void* bytes, std::size_t count, off_t position) {
  return fails(writing, "pwrite") ? -1 : real(pwrite, "pwrite")(file, bytes, count, position);
}
ssize_t writev(int file, const iovec* parts, int count) {
  return fails(writing, "writev") ? -1 : real(writev, "writev")(file, parts, count);
}
int ftruncate(int file, off_t length) noexcept {
  return fails(writing, "ftruncate") ? -1 : real(ftruncate, "ftruncate")(file, length);
}
int fflush(std::FILE* file) { return fails(writing, "fflush") ? EOF : real(fflush, "fflush")(file); }

int fsync(int file) { return fails(syncing, "fsync") ? -1 : real(fsync, "fsync")(file); }
int rename(const char* from, const char* to) noexcept {
  if (fails(stopping, to)) ::kill(::getpid(), SIGTERM);
  return fails(renaming, to) ? -1 : real(rename, "rename")(from, to);
}

// The file is closed even if the call fails, as in Linux.
int close(int file) {
  const int status = real(close, "close")(file);
  return fails(closing, "close") ? -1 : status;
}
int fclose(std::FILE* file) {
  const int status = real(fclose, "fclose")(file);
  return fails(closing, "fclose") ? EOF : status;
}

/// Constant time, so that two runs write equal outputs.
std::time_t time(std::time_t* result) noexcept {
  constexpr std::time_t now = 1'300'000'000;
  if (result != nullptr) *result = now;
  return now;
}

}  // extern "C"
