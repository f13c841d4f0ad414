#pragma once

namespace pcor::tool {

/// During its lifetime, a crash or an endless loop in the libraries that read files, as on a damaged flight,
/// and their exit if memory is exhausted, end like other errors: with status 1 and a line that names the
/// flight, and without unfinished files. A crash of pcor is unchanged.
class CrashesExplained {
 public:
  CrashesExplained();
  CrashesExplained(const CrashesExplained&) = delete;
  CrashesExplained& operator=(const CrashesExplained&) = delete;
  ~CrashesExplained();
};

}  // namespace pcor::tool
