#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace pcor::tool {

/// Progress bar on standard error. It appears on a terminal only, after half a second of work, so that logs
/// and short runs stay clean. A program that requests events gets the numbers instead, the first at once.
class Progress {
 public:
  Progress(std::string task, bool requested);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  /// Shows that `done` of `total` parts are done.
  void show(std::size_t done, std::size_t total);

 private:
  void erase();

  std::string task_;
  bool requested_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace pcor::tool
