// The check of layers: its result, and the reasons for no result.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include <pcor/physics/standard_atmosphere.hpp>
#include "checks/checks.hpp"
#include "checks/standard_air.hpp"
#include "numerics/missing.hpp"
#include "support/says.hpp"

using namespace pcor::internal;

namespace pcor {
namespace {

using internal::nan;
using testing::HasSubstr;

/// A climb and a descent in the standard atmosphere, with a thermometer that is too warm.
CheckedFlight climb_and_descent(double too_warm) {
  CheckedFlight flight;
  std::vector<double> heights;
  for (int i = 0; i <= 1600; ++i) heights.push_back(1000.0 + 5.0 * std::min(i, 1600 - i));
  flight.air = test::standard_air(heights, too_warm);
  return flight;
}

TEST(LayersCheck, CorrectThermometerPasses) {
  const CheckResult result = check_layers({climb_and_descent(0.0)});
  ASSERT_TRUE(result.was_run) << result.reason;
  // One flight, with the usual errors of delta-p, does not detect 0.3 K at two standard errors.
  EXPECT_EQ(result.verdict, CheckVerdict::inconclusive);
  EXPECT_EQ(result.number("layers"), 8.0);
  EXPECT_NEAR(result.number("offset_k"), 0.0, 0.01);
  EXPECT_THAT(result.limitations, HasSubstr("delta-p"));
}

TEST(LayersCheck, FindsAnOffsetBeyondItsError) {
  const CheckResult result = check_layers({climb_and_descent(2.0)});
  ASSERT_TRUE(result.was_run);
  EXPECT_EQ(result.verdict, CheckVerdict::inconsistent);
  EXPECT_NEAR(result.number("offset_k"), -2.0, 0.01);
  EXPECT_THAT(result.finding, HasSubstr("-2.00"));
}

TEST(LayersCheck, ReasonForNoResultIsReported) {
  CheckedFlight feet = climb_and_descent(0.0);
  feet.air.height_scale_problem = "heights in feet";
  EXPECT_THAT(check_layers({feet}).reason, HasSubstr("heights in feet"));
  CheckedFlight without = climb_and_descent(0.0);
  without.air.height.clear();
  EXPECT_THAT(check_layers({without}).reason, HasSubstr("no unit"));
  without.air.height_variable.clear();
  EXPECT_THAT(check_layers({without}).reason, HasSubstr("GPS height"));
  without = climb_and_descent(0.0);
  without.air.latitude.clear();
  EXPECT_THAT(check_layers({without}).reason, HasSubstr("latitude"));
  without = climb_and_descent(0.0);
  without.air.temperature.clear();
  EXPECT_THAT(check_layers({without}).reason, HasSubstr("thermometer"));
  CheckedFlight level = climb_and_descent(0.0);
  for (std::size_t i = 0; i < level.air.size(); ++i) {
    level.air.height[i] = level.air.geopotential_height[i] = level.air.pressure_altitude[i] = 3000.0;
    level.air.pressure[i] = standard_pressure(3000.0);
  }
  EXPECT_THAT(check_layers({level}).reason, HasSubstr("no climb"));
  CheckedFlight dropouts = climb_and_descent(0.0);
  for (std::size_t i = 0; i < dropouts.air.size(); i += 50) dropouts.air.geopotential_height[i] = nan;
  EXPECT_THAT(check_layers({dropouts}).reason, HasSubstr("gap"));
}

TEST(LayersCheck, FlightWithoutHeightIsSkippedAndReported) {
  CheckedFlight without = climb_and_descent(0.0);
  without.air.height.clear();
  const CheckResult result = check_layers({without, climb_and_descent(0.0)});
  ASSERT_TRUE(result.was_run);
  EXPECT_THAT(result.notes, testing::Contains(test::Says("GPS height")));
  // Pictures have a value for every record of all flights.
  for (const ReportColumn& column : result.columns)
    EXPECT_EQ(column.values.size(), 2U * 1601U) << column.name;
}

}  // namespace
}  // namespace pcor
