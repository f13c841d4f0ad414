#include <pcor/base/note.hpp>

namespace pcor {

std::string_view to_string(Severity severity) {
  return severity == Severity::warning ? "warning" : "information";
}

std::string format_note(const Note& note) {
  return note.severity == Severity::warning ? "warning: " + note.text : note.text;
}

std::string_view label_of(const Note& note) {
  return note.severity == Severity::warning ? "Warning" : "Note";
}

}  // namespace pcor
