#include <pcor/physics/lift.hpp>

#include <gtest/gtest.h>

#include <cmath>

using pcor::lift_number;
using pcor::load_factor;

namespace {

// The numbers are exact but for rounding.
constexpr double rounding = 1e-12;

TEST(LoadFactor, IsOneInLevelFlightAndTwoInATurnOfSixtyDegrees) {
  EXPECT_NEAR(load_factor(0.0, 0.0), 1.0, rounding);
  EXPECT_NEAR(load_factor(0.0, 60.0), 2.0, rounding);
  EXPECT_NEAR(load_factor(0.0, -60.0), 2.0, rounding) << "to either side";
}

TEST(LoadFactor, IsNothingInFreeFall) { EXPECT_NEAR(load_factor(-9.80665, 20.0), 0.0, rounding); }

TEST(LiftNumber, IsLoadOverDynamicPressureInSlowFlight) {
  EXPECT_NEAR(lift_number(1.0, 0.0, 50.0), 0.02, rounding);
  EXPECT_NEAR(lift_number(2.0, 0.0, 50.0), 0.04, rounding);
}

TEST(LiftNumber, FallsWithTheMachNumberAsTheWingLiftsMore) {
  EXPECT_NEAR(lift_number(1.0, 0.6, 50.0), 0.8 * 0.02, rounding);
  EXPECT_TRUE(std::isnan(lift_number(std::nan(""), 0.6, 50.0)));
}

}  // namespace
