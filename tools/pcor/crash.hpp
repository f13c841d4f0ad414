#pragma once

namespace pcor::tool {

/// During its lifetime, a crash or an endless loop in the libraries that read files, as on a damaged flight,
/// and their exit if memory is exhausted, end like other errors: with a line that names the flight, and
/// without unfinished files. A crash of pcor is unchanged.
class CrashesExplained {
 public:
  /// @param status exit status of the process in these cases
  explicit CrashesExplained(int status);
  CrashesExplained(const CrashesExplained&) = delete;
  CrashesExplained& operator=(const CrashesExplained&) = delete;
  ~CrashesExplained();
};

}  // namespace pcor::tool
