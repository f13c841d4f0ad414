#include "base/phrasing.hpp"

#include <gtest/gtest.h>

using namespace pcor::internal;

namespace {

TEST(Phrasing, SentenceHasCapitalAndFullStop) {
  EXPECT_EQ(sentence("the fit is done"), "The fit is done.");
  EXPECT_EQ(sentence("Is it?"), "Is it?");
  EXPECT_EQ(sentence(""), "");
  // Names keep their spelling.
  EXPECT_EQ(sentence("rf01.nc: no GPS height"), "rf01.nc: no GPS height.");
  EXPECT_EQ(sentence("static-qp.a2 is held"), "static-qp.a2 is held.");
}

TEST(Phrasing, JoinsListWithAnd) {
  EXPECT_EQ(join_list({}), "");
  EXPECT_EQ(join_list({"a"}), "a");
  EXPECT_EQ(join_list({"a", "b"}), "a and b");
  EXPECT_EQ(join_list({"a", "b", "c"}), "a, b and c");
}

TEST(Phrasing, ShowsTwoDigitsOfAnError) {
  EXPECT_EQ(decimals_of_error(0.0046), 4);
  EXPECT_EQ(decimals_of_error(0.0996), 2);  // rounds to 0.10
  EXPECT_EQ(decimals_of_error(0.1), 2);
  EXPECT_EQ(decimals_of_error(34.0), 0);
}

TEST(Phrasing, MergesNotesOfFlightsBySeverityAndText) {
  using pcor::Note;
  using pcor::warning_note;
  const pcor::Notes merged = notes_of_flights({{"a.nc", warning_note("PSFD is frozen")},
                                               {"a.nc", Note("PSFD is frozen")},
                                               {"b.nc", warning_note("PSFD is frozen")},
                                               {"a.nc", warning_note("PSFD is frozen")}},
                                              2);
  EXPECT_EQ(merged, (pcor::Notes{warning_note("a.nc, b.nc: PSFD is frozen"), Note("a.nc: PSFD is frozen")}));
  EXPECT_EQ(notes_of_flights({{"a.nc", Note("PSFD is frozen")}}, 1), (pcor::Notes{Note("PSFD is frozen")}));
}

}  // namespace
