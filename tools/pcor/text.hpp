#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pcor/base/note.hpp>
#include <pcor/base/shell_quote.hpp>

namespace pcor::tool {

/// Program as the user called it, quoted for a shell: printed commands begin with it. "pcor" until
/// `set_program`.
const std::string& program();
void set_program(const std::string& name_as_called);

/// Prints text for people on standard output, with lines folded at the width of the terminal, verdicts of
/// checks in colour and labels of notes bold unless NO_COLOR is set. If standard output is not a terminal the
/// text is unchanged.
void print_text(std::string_view text);

/// Disables terminal formatting. MPI may connect its processes to a terminal.
void disable_terminal_style();

/// Prints like `print_text`, formatted as by fmt::print.
template <class... Arguments>
void print_formatted(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  print_text(fmt::format(format, std::forward<Arguments>(arguments)...));
}

/// Prints an error in one line on standard error, on the first rank only. Failures to write are ignored.
void print_error(const std::string& message);

/// Prints the unfinished line that `print_text` keeps.
void flush_text();

/// Whether commands print all details: false until `print_all_details`, by --verbose.
bool is_verbose();
void print_all_details();

/// Prints notes without full stops as numbered, shortened lines, warnings first, at most `max_notes`; all in
/// full if `is_verbose`.
void print_notes(Notes notes, std::size_t max_notes = 3);

/// Notes with warnings about the same result.
Notes with_warnings(const std::vector<std::string>& warnings, Notes notes);

/// Prints automatic choices on standard error, unless `quiet`, a sentence each, and stores them for
/// `choices_of_this_run`.
void tell_choices(const Notes& choices, bool quiet);

/// Automatic choices of this run: variables and models that were not specified, skipped flights. JSON results
/// and reports include them.
const std::vector<std::string>& choices_of_this_run();

/// Registers a file that exists before the run, for `print_written_files`.
void remember_existing(const std::filesystem::path& file);

/// "wrote" or, for a file that existed before the run, "overwrote".
std::string_view wrote(const std::filesystem::path& file);

/// Prints the names of written files on a separate line: "wrote best.toml; overwrote improve.html". Empty
/// names and `-` are ignored.
void print_written_files(const std::vector<std::string>& files);

/// Line folded to lines of at most `width` characters, at blanks; continuation lines are indented, below the
/// text if the line begins with a name in a separate column. Rows of a table are broken between columns. A
/// command at the end stays on one line, so that it can be pasted.
std::string wrapped(std::string_view line, std::size_t width);

}  // namespace pcor::tool
