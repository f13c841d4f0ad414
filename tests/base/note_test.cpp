#include <pcor/base/note.hpp>

#include <gtest/gtest.h>

#include <algorithm>

namespace pcor {
namespace {

TEST(Note, TextHasTheSeverityInformation) {
  const Note note = "PSFD varies";
  EXPECT_EQ(note.severity, Severity::information);
  EXPECT_EQ(format_note(note), note.text);
}

TEST(Note, SortingPutsWarningsFirst) {
  const Note detail{Severity::detail, "0"};
  Notes notes{detail, "a", warning_note("z"), warning_note("b")};
  std::sort(notes.begin(), notes.end());
  EXPECT_EQ(notes, (Notes{warning_note("b"), warning_note("z"), "a", detail}));
  EXPECT_EQ(to_string(detail.severity), "detail");
}

}  // namespace
}  // namespace pcor
