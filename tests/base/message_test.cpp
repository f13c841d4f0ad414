#include <pcor/base/message.hpp>

#include <gtest/gtest.h>

namespace pcor {
namespace {

TEST(Message, WarningNoteIsRecognisedAlsoAfterItsFlight) {
  const std::string warning = warning_note("PSFD is frozen");
  EXPECT_TRUE(is_warning_note(warning));
  EXPECT_TRUE(is_warning_note("rf01.nc, rf02.nc: " + warning));
  EXPECT_FALSE(is_warning_note("rf01.nc: PSFD is frozen"));
  EXPECT_FALSE(is_warning_note("no warning: PSFD varies"));
}

}  // namespace
}  // namespace pcor
