#include "text.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <utility>

#include <pcor/base/message.hpp>
#include "communicator.hpp"

namespace pcor::tool {
namespace {

constexpr std::size_t min_width = 20;
constexpr auto none = std::string_view::npos;

bool is_plain = false;
bool with_details = false;
std::vector<std::string> automatic_choices;

std::string& program_name() {
  static std::string name = "pcor";
  return name;
}

/// Width of the terminal at standard output, which COLUMNS may set; 0 if it is not a terminal.
std::size_t terminal_width() {
  if (is_plain || isatty(fileno(stdout)) != 1) return 0;
  winsize size{};
  long width = ioctl(fileno(stdout), TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
  if (const char* const stated = std::getenv("COLUMNS")) width = std::atol(stated);
  return width <= 0 ? 0 : std::max(min_width, static_cast<std::size_t>(width));
}

/// Number of columns of a line, separated by two blanks or more.
std::size_t columns_in(std::string_view line) {
  std::size_t columns = 0;
  for (std::size_t at = line.find_first_not_of(' '); at != none; at = line.find_first_not_of(' ', at)) {
    ++columns;
    at = line.find("  ", at);
  }
  return columns;
}

/// Indent of the lines after the first one.
std::size_t hanging_indent(std::string_view line, std::size_t width) {
  const std::size_t indent = line.find_first_not_of(' ');
  const std::size_t gap = line.find("  ", indent);
  const std::size_t column = gap == none ? none : line.find_first_not_of(' ', gap);
  if (column != none && column <= width / 2) return column;
  return indent > width / 4 ? std::min(indent, width / 2) : indent + 2;
}

/// Number of bytes of `text` in at most `width` characters of UTF-8.
std::size_t bytes_of(std::string_view text, std::size_t width) {
  std::size_t letters = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool begins_letter = (static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80U;
    if (begins_letter && ++letters > width) return i;
  }
  return text.size();
}

/// Removes a first line of at most `width` characters from `text`; for a row of a table only complete
/// columns; a longer word is not broken.
std::string_view take_line(std::string_view& text, std::size_t width, bool is_row) {
  const std::size_t fits = bytes_of(text, width);
  if (fits == text.size()) return std::exchange(text, {});
  const std::size_t begin = text.find_first_not_of(' ');
  std::size_t blank = is_row ? text.rfind("  ", fits) : none;
  if (blank == none || blank < begin) blank = text.rfind(' ', fits);
  if (blank == none || blank < begin) blank = text.find(' ', fits);
  const std::string_view line = text.substr(0, blank);
  const std::size_t next = blank == none ? none : text.find_first_not_of(' ', blank);
  text = next == none ? std::string_view{} : text.substr(next);
  return line.substr(0, line.find_last_not_of(' ') + 1);
}

}  // namespace

const std::string& program() { return program_name(); }

void set_program(const std::string& name_as_called) { program_name() = shell_quote(name_as_called); }

void disable_terminal_style() { is_plain = true; }

bool is_verbose() { return with_details; }

void print_all_details() { with_details = true; }

std::string wrapped(std::string_view line, std::size_t width) {
  if (bytes_of(line, width) == line.size()) return std::string(line);
  // The pieces of a command would run alone if they are pasted.
  if (line.rfind("  " + program() + " ", 0) == 0) return std::string(line);
  const std::size_t command = line.find(": " + program() + " ");
  std::string_view rest = line.substr(0, command == none ? none : command + 1);
  const std::size_t indent = hanging_indent(line, width);
  const bool is_row = columns_in(line) > 2;
  std::string text(take_line(rest, width, is_row));
  while (!rest.empty()) text += fmt::format("\n{:{}}{}", "", indent, take_line(rest, width - indent, is_row));
  if (command != none) text += fmt::format("\n  {}", line.substr(command + 2));
  return text;
}

namespace {

/// Beginning of a line whose end is still missing; it can be folded only when complete.
std::string& unfinished_line() {
  static std::string line;
  return line;
}

bool wants_colour() {
  const char* const refused = std::getenv("NO_COLOR");
  const char* const terminal = std::getenv("TERM");
  return (refused == nullptr || *refused == '\0') && terminal != nullptr &&
         std::string_view(terminal) != "dumb";
}

/// Label of a note ("note 2", "warning 1", "Note", "Warning") bold, and verdict in a row of a table in
/// colour.
std::string coloured(std::string line) {
  constexpr std::string_view plain = "\033[0m";
  const auto paint = [&](std::size_t at, std::size_t length, std::string_view colour) {
    line.insert(at + length, plain);
    line.insert(at, colour);
  };
  for (const std::string_view label : {"note ", "warning ", "Note:", "Warning:"}) {
    if (line.rfind(label, 0) == 0) paint(0, std::min(line.find(':'), line.size()), "\033[1m");
  }
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> verdicts{
      {{"inconsistent", "\033[31m"}, {"consistent", "\033[32m"}, {"inconclusive", "\033[33m"}}};
  for (const auto& [verdict, colour] : verdicts) {
    const std::size_t at = line.find(fmt::format("  {}", verdict));
    if (at == none) continue;
    // A cell ends with two blanks, or with the line, which may be folded.
    const std::size_t end = at + 2 + verdict.size();
    if (end == line.size() || line[end] == '\n' || line.compare(end, 2, "  ") == 0)
      paint(at + 2, verdict.size(), colour);
  }
  return line;
}

}  // namespace

void print_error(const std::string& message) {
  if (!is_speaker()) return;
  const std::string line = sanitize_line(message) + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);
}

void print_text(std::string_view said) {
  static const std::size_t width = terminal_width();
  static const bool colour = wants_colour();
  const std::string shown = sanitize_text(said);
  std::string_view text = shown;
  if (width == 0) {
    fmt::print("{}", text);
    return;
  }
  for (std::size_t end = text.find('\n'); end != none; end = text.find('\n')) {
    std::string line = wrapped(unfinished_line().append(text.substr(0, end)), width);
    fmt::print("{}\n", colour ? coloured(std::move(line)) : line);
    unfinished_line().clear();
    text.remove_prefix(end + 1);
  }
  unfinished_line().append(text);
}

void flush_text() {
  if (!unfinished_line().empty()) fmt::print("{}", unfinished_line());
  unfinished_line().clear();
}

void print_notes(Notes notes, std::size_t max_notes) {
  constexpr std::size_t max_width = 136;
  std::stable_sort(notes.begin(), notes.end(),
                   [](const Note& a, const Note& b) { return a.severity < b.severity; });
  if (is_verbose()) {
    for (const Note& note : notes) print_formatted("\n{}: {}.\n", label_of(note), note.text);
    print_formatted("\n");
    return;
  }
  while (!notes.empty() && notes.back().severity == Severity::detail) notes.pop_back();
  bool is_cut = false;  // a note before
  for (std::size_t i = 0; i < std::min(notes.size(), max_notes); ++i) {
    // A note begins with the fault or the action: complete clauses stay if the first one fits.
    const std::string& note = notes[i].text;
    const char* const label = notes[i].severity == Severity::warning ? "warning" : "note";
    const bool is_short = bytes_of(note, max_width) == note.size();
    std::string_view line = note;
    if (!is_short) {
      const std::size_t clauses = note.rfind("; ", bytes_of(note, max_width));
      line = clauses == none ? take_line(line, max_width, false) : line.substr(0, clauses);
    }
    print_formatted("{} {}: {}{}\n", label, i + 1, line,
                    is_short ? "."
                    : is_cut ? " ..."
                             : " ... (in full with --verbose)");
    is_cut = is_cut || !is_short;
  }
  if (notes.size() > max_notes) print_formatted("more notes: {} (add --verbose)\n", notes.size() - max_notes);
}

Notes with_warnings(const std::vector<std::string>& warnings, Notes notes) {
  std::transform(warnings.begin(), warnings.end(), std::back_inserter(notes), warning_note);
  return notes;
}

void tell_choices(const Notes& choices, bool quiet) {
  for (const Note& choice : choices) {
    if (!quiet) print_error(format_note(choice));
    automatic_choices.push_back(format_note(choice));
  }
}

const std::vector<std::string>& choices_of_this_run() { return automatic_choices; }

namespace {

std::set<std::filesystem::path>& existing_files() {
  static std::set<std::filesystem::path> files;
  return files;
}

}  // namespace

void remember_existing(const std::filesystem::path& file) { existing_files().insert(file); }

std::string_view wrote(const std::filesystem::path& file) {
  return existing_files().count(file) == 0 ? "wrote" : "overwrote";
}

void print_written_files(const std::vector<std::string>& files) {
  std::string line;
  for (const std::string_view verb : {"wrote", "overwrote"}) {
    std::string names;
    for (const std::string& file : files) {
      if (!file.empty() && file != "-" && wrote(file) == verb) names += (names.empty() ? " " : ", ") + file;
    }
    if (!names.empty()) line += fmt::format("{}{}{}", line.empty() ? "" : "; ", verb, names);
  }
  if (!line.empty()) print_formatted("{}\n", line);
}

}  // namespace pcor::tool
