#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace pcor {

/// Error of the offline library.
///
/// The message is one line: file, variable or line, the problem, and the action to take. The code is for
/// programs that handle errors; they need not parse the message.
class Error : public std::runtime_error {
 public:
  enum class Code : std::uint8_t {
    other,
    file,      ///< a file cannot be read, or is damaged
    variable,  ///< a variable is absent or has no value
    unit,      ///< a unit is missing, unknown or not convertible
    model,     ///< the model cannot be used on the recorded variables
    output     ///< an output cannot be written to its path
  };

  explicit Error(const std::string& message) : Error(Code::other, message) {}
  Error(Code code, const std::string& message) : std::runtime_error(message), code_(code) {}

  Code code() const { return code_; }

 private:
  Code code_;
};

}  // namespace pcor
