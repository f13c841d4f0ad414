#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

namespace pcor {

/// Error of the offline library.
///
/// The message is one line: file, variable or line, the problem, and the action to take. The code is for
/// programs that handle errors; they need not parse the message.
class Error : public std::runtime_error {
 public:
  enum class Code : std::uint8_t {
    file,        ///< a file cannot be read, or is damaged
    variable,    ///< a variable is absent, has no value or cannot be used
    unit,        ///< a unit is missing, unknown or not convertible
    time,        ///< a time is missing or ambiguous, or the times do not increase
    samples,     ///< the usable samples are too few, or their rate cannot be used
    definition,  ///< a model file, scenario, file of intervals or formula is not valid
    model,       ///< no model is determined, or the model cannot be used on the recorded variables
    fit,         ///< a fit has no solution, does not determine it, or gives a worse model
    usage,       ///< an option or argument is impossible, or contradicts another one
    output,      ///< an output cannot be written to its path
    system       ///< memory, a process or another program is not available, or pcor has an internal error
  };

  Error(Code code, const std::string& message) : std::runtime_error(message), code_(code) {}

  Code code() const { return code_; }

 private:
  Code code_;
};

/// The name of the code, such as "file".
constexpr std::string_view to_string(Error::Code code) {
  // In the order of the codes.
  constexpr std::array<std::string_view, 11> names{"file",    "variable",   "unit",  "time",
                                                   "samples", "definition", "model", "fit",
                                                   "usage",   "output",     "system"};
  static_assert(names.size() == static_cast<std::size_t>(Error::Code::system) + 1);
  return names[static_cast<std::size_t>(code)];
}

}  // namespace pcor
