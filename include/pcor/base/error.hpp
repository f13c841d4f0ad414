#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace pcor {

/// The one error of the offline library: work that cannot be done.
///
/// The message is one line for people. It says which file, variable or line, what was wrong, and what to do
/// about it. The code is for programs that can go on in another way: they never read the message.
class Error : public std::runtime_error {
 public:
  enum class Code : std::uint8_t {
    other,
    file,      ///< it cannot be read, or is damaged
    variable,  ///< a flight has no variable of that name, or no value of it
    unit,      ///< a variable has no unit, one that is not known, or one that does not convert
    model,     ///< the model cannot be used on what is recorded
    output     ///< an output cannot be written where it was asked for
  };

  explicit Error(const std::string& message) : Error(Code::other, message) {}
  Error(Code code, const std::string& message) : std::runtime_error(message), code_(code) {}

  Code code() const { return code_; }

 private:
  Code code_;
};

}  // namespace pcor
