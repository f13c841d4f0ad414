#include "improve/rival_choice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

using pcor::internal::choose_rival;
using pcor::internal::RivalChoice;

namespace {

using Series = std::vector<double>;

TEST(RivalChoice, MoreProbableRivalIsChosen) {
  const RivalChoice choice = choose_rival({Series(10, 0.8), Series(10, 1.2)}, {0.75, 0.25}, 0.01);
  ASSERT_TRUE(choice.rival.has_value());
  EXPECT_EQ(*choice.rival, 0U);
  EXPECT_NEAR(choice.error, std::sqrt(0.25) * 0.4, 1e-12);  // rounding
}

TEST(RivalChoice, MiddleRivalOfLeastErrorIsChosen) {
  const RivalChoice choice =
      choose_rival({Series(5, 0.5), Series(5, 1.0), Series(5, 1.5)}, {0.4, 0.3, 0.3}, 0.01);
  ASSERT_TRUE(choice.rival.has_value());
  EXPECT_EQ(*choice.rival, 1U);
}

TEST(RivalChoice, AppliesNoRivalIfAnotherMakesItHarmful) {
  const RivalChoice choice = choose_rival({Series(10, 0.8), Series(10, -0.6)}, {0.9, 0.1}, 0.01);
  EXPECT_FALSE(choice.rival.has_value());
  EXPECT_NEAR(choice.error, std::sqrt(0.9 * 0.64 + 0.1 * 0.36), 1e-12);  // rounding
}

TEST(RivalChoice, UnchangedRivalLimitsCorrectionToTolerance) {
  EXPECT_FALSE(choose_rival({Series(10, 0.5), Series(10, 0.0)}, {0.99, 0.01}, 0.01).rival.has_value());
  EXPECT_TRUE(choose_rival({Series(10, 0.009), Series(10, 0.0)}, {0.99, 0.01}, 0.01).rival.has_value());
}

TEST(RivalChoice, IrrelevantDifferencesKeepTheFirstRival) {
  EXPECT_EQ(choose_rival({Series(10, 0.004), Series(10, -0.004)}, {0.5, 0.5}, 0.01).rival, 0U);
  EXPECT_EQ(choose_rival({Series(10, 0.0), Series(10, 0.0)}, {0.5, 0.5}, 0.0).rival, 0U);
}

TEST(RivalChoice, MissingSamplesAreIgnored) {
  const double missing = std::numeric_limits<double>::quiet_NaN();
  const RivalChoice choice = choose_rival({{1.0, missing, 1.0}, {1.0, 5.0, missing}}, {0.5, 0.5}, 0.01);
  ASSERT_TRUE(choice.rival.has_value());
  EXPECT_EQ(choice.error, 0.0);
}

}  // namespace
