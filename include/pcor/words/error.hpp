#pragma once

#include <stdexcept>

namespace pcor {

/// The one error of the offline library: work that cannot be done.
///
/// The message is one line. It says which file, variable or line, what was wrong, and what to do about it.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace pcor
