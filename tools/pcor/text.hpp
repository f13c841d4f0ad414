#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pcor/base/shell_quote.hpp>

namespace pcor::tool {

/// The program as the user called it, as a shell takes it: commands that are printed for copying begin with
/// it. "pcor" until `set_program`.
const std::string& program();
void set_program(const std::string& name_as_called);

/// Prints text for people on standard output, whose lines are folded at the width of the terminal, with the
/// verdicts of checks in colour and notes bold unless NO_COLOR is set. Where standard output is no
/// terminal they stay as they are.
void say_text(std::string_view text);

/// From now on standard output counts as no terminal. MPI may pass what its processes print through one.
void say_plainly();

/// As `say_text`, formatted as by fmt::print.
template <class... Arguments>
void say(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  say_text(fmt::format(format, std::forward<Arguments>(arguments)...));
}

/// Says on standard error, in one line, what is wrong; of a team the first member does. EffectLocation
/// standard error takes nothing, it is not said.
void tell(const std::string& message);

/// Prints what `say` keeps of a line that has no end yet.
void finish_text();

/// Says which files were written, on a line of its own: "wrote best.toml, improve.html". Empty names and `-`
/// are no files.
void say_written(const std::vector<std::string>& files);

/// A line in lines of at most `width` letters, broken at blanks; what follows is indented, under the text
/// where the line begins with a name in a column of its own. Rows of a table are broken between columns. A
/// command to copy at its end stays whole, for a broken one cannot be pasted.
std::string folded(std::string_view line, std::size_t width);

}  // namespace pcor::tool
