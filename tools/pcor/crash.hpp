#pragma once

namespace pcor::tool {

/// As long as one lives, a crash in the libraries that read files, as on a damaged flight, one from which
/// they never come back, and their way of ending a program that has no memory left end like other errors:
/// with a line that names the flight that was read, and nothing unfinished left behind. A crash of pcor
/// itself stays what it is.
class CrashesExplained {
 public:
  /// @param status with which the process ends then
  explicit CrashesExplained(int status);
  CrashesExplained(const CrashesExplained&) = delete;
  CrashesExplained& operator=(const CrashesExplained&) = delete;
  ~CrashesExplained();
};

}  // namespace pcor::tool
