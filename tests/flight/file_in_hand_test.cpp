#include "flight/file_in_hand.hpp"

#include <gtest/gtest.h>

#include <filesystem>

namespace pcor::internal {
namespace {

TEST(FileInHand, IsTheOneThatIsReadLast) {
  const std::filesystem::path outer = "outer.nc", inner = "inner.nc";
  EXPECT_EQ(file_in_hand(), nullptr);
  EXPECT_EQ(seconds_in_hand(), 0.0);
  {
    const FileInHand first(outer);
    EXPECT_STREQ(file_in_hand(), "outer.nc");
    { const FileInHand again(outer); }
    EXPECT_FALSE(others_were_in_hand());
    {
      const FileInHand second(inner);
      EXPECT_STREQ(file_in_hand(), "inner.nc");
      EXPECT_TRUE(others_were_in_hand());
    }
    EXPECT_STREQ(file_in_hand(), "outer.nc");
  }
  EXPECT_EQ(file_in_hand(), nullptr);
}

TEST(FileInHand, CountsTheTimeThatIsWorkedOnIt) {
  const std::filesystem::path path = "flight.nc";
  const FileInHand in_hand(path);
  const double before = seconds_in_hand();
  EXPECT_GE(before, 0.0);
  while (seconds_in_hand() < before + 0.01) {
  }
  const FileInHand again(path);
  EXPECT_LT(seconds_in_hand(), 0.01) << "from the beginning";
}

}  // namespace
}  // namespace pcor::internal
