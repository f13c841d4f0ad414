#include <pcor/physics/lift.hpp>

#include <gtest/gtest.h>

using pcor::load_factor;

namespace {

// The numbers are exact except for rounding.
constexpr double rounding = 1e-12;

TEST(LoadFactor, IsOneInLevelFlightAndTwoAtSixtyDegrees) {
  EXPECT_NEAR(load_factor(0.0, 0.0), 1.0, rounding);
  EXPECT_NEAR(load_factor(0.0, 60.0), 2.0, rounding);
  EXPECT_NEAR(load_factor(0.0, -60.0), 2.0, rounding) << "either side";
}

TEST(LoadFactor, IsZeroInFreeFall) { EXPECT_NEAR(load_factor(-9.80665, 20.0), 0.0, rounding); }

}  // namespace
