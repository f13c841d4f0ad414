#pragma once

#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

namespace pcor {

/// Severity of a note, most severe first.
enum class Severity {
  warning,      ///< the data or the set-up may invalidate the result
  information,  ///< a choice or a limitation to know
  detail        ///< a usual choice: commands print it with --verbose only
};

/// Text: "warning", "information", "detail".
inline std::string_view to_string(Severity severity) {
  return severity == Severity::warning ? "warning" : severity == Severity::detail ? "detail" : "information";
}

/// Note about a result for the user. A text converts to a note with the severity information.
struct Note {
  Severity severity = Severity::information;
  std::string text{};  ///< sentence without full stop

  Note() = default;
  Note(std::string sentence) : text(std::move(sentence)) {}
  Note(const char* sentence) : text(sentence) {}
  Note(Severity how, std::string sentence) : severity(how), text(std::move(sentence)) {}

  template <class Archive>
  void serialize(Archive& archive) {
    archive(severity, text);
  }

  // A friend, so that a text, which converts to a note, is not described as one.
  template <class Field>
  friend void describe(const Note& self, Field& field) {
    field("severity", self.severity,
          "warning: the data may invalidate the result; information; detail: a usual choice");
    field("text", self.text, "the note, a sentence without full stop");
  }
};

using Notes = std::vector<Note>;

inline bool operator==(const Note& a, const Note& b) { return a.severity == b.severity && a.text == b.text; }
/// By severity, then alphabetical.
inline bool operator<(const Note& a, const Note& b) {
  return std::tie(a.severity, a.text) < std::tie(b.severity, b.text);
}

inline Note warning_note(std::string text) { return {Severity::warning, std::move(text)}; }

/// Text for one line of output, with the prefix "warning: " for a warning.
inline std::string format_note(const Note& note) {
  return note.severity == Severity::warning ? "warning: " + note.text : note.text;
}

/// "Warning" or "Note", the label of a note in reports and long output.
inline std::string_view label_of(const Note& note) {
  return note.severity == Severity::warning ? "Warning" : "Note";
}

}  // namespace pcor
