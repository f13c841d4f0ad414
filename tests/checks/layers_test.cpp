// The check of layers: its result, and the reasons for no result.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <pcor/physics/standard_atmosphere.hpp>
#include "checks/checks.hpp"
#include "support/says.hpp"

using namespace pcor::internal;

namespace pcor {
namespace {

using testing::HasSubstr;

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

/// A climb and a descent in the standard atmosphere, with a thermometer that is too warm.
CheckedFlight made(double too_warm) {
  CheckedFlight flight;
  FlightAir& air = flight.air;
  auto samples = std::make_shared<FlightSamples>();
  samples->name = "made.nc";
  for (int i = 0; i <= 1600; ++i) {
    const double height = 1000.0 + 5.0 * std::min(i, 1600 - i);
    samples->time.push_back(1e9 + i);
    air.height.push_back(height);
    air.pressure.push_back(standard_pressure(height));
    air.temperature.push_back(standard_temperature(height) + too_warm);
  }
  const std::size_t count = air.height.size();
  air.height_variable = "GGALT";
  air.geopotential_height = air.height;
  air.pressure_altitude = air.height;
  air.flying.assign(count, true);
  air.gas_constant.assign(count, 8314.32 / 28.9644);
  air.airspeed.assign(count, 100.0);
  air.east_speed.assign(count, 100.0);
  air.north_speed.assign(count, 0.0);
  air.latitude.assign(count, 45.0);
  air.d_value.assign(count, 0.0);
  air.samples = std::move(samples);
  return flight;
}

std::map<std::string, double> numbers_of(const CheckResult& result) {
  return {result.numbers.begin(), result.numbers.end()};
}

TEST(LayersCheck, CorrectThermometerPasses) {
  const CheckResult result = check_layers({made(0.0)});
  ASSERT_TRUE(result.ran) << result.reason;
  // One flight, with the usual errors of delta-p, does not detect 0.3 K at two standard errors.
  EXPECT_EQ(result.verdict, CheckVerdict::inconclusive);
  EXPECT_EQ(numbers_of(result).at("layers"), 8.0);
  EXPECT_NEAR(numbers_of(result).at("offset_k"), 0.0, 0.01);
  EXPECT_THAT(result.cannot_see, HasSubstr("delta-p"));
}

TEST(LayersCheck, FindsAnOffsetBeyondItsError) {
  const CheckResult result = check_layers({made(2.0)});
  ASSERT_TRUE(result.ran);
  EXPECT_EQ(result.verdict, CheckVerdict::inconsistent);
  EXPECT_NEAR(numbers_of(result).at("offset_k"), -2.0, 0.01);
  EXPECT_THAT(result.finding, HasSubstr("-2.00"));
}

TEST(LayersCheck, ReasonForNoResultIsReported) {
  EXPECT_FALSE(check_layers({}).ran);
  CheckedFlight feet = made(0.0);
  for (double& height : feet.air.geopotential_height) height /= 0.3048;
  EXPECT_THAT(check_layers({feet}).reason, HasSubstr("feet"));
  CheckedFlight rising = made(0.0);
  for (std::size_t i = 0; i < rising.air.size(); ++i) {
    rising.air.pressure_altitude[i] = 6000.0 - rising.air.pressure_altitude[i];
    rising.air.pressure[i] = standard_pressure(rising.air.pressure_altitude[i]);
  }
  EXPECT_THAT(check_layers({rising}).reason, HasSubstr("times as fast as the pressure altitude"));
  CheckedFlight without = made(0.0);
  without.air.height.clear();
  EXPECT_THAT(check_layers({without}).reason, HasSubstr("no unit"));
  without.air.height_variable.clear();
  EXPECT_THAT(check_layers({without}).reason, HasSubstr("GPS height"));
  without = made(0.0);
  without.air.latitude.clear();
  EXPECT_THAT(check_layers({without}).reason, HasSubstr("latitude"));
  without = made(0.0);
  without.air.temperature.clear();
  EXPECT_THAT(check_layers({without}).reason, HasSubstr("thermometer"));
  CheckedFlight level = made(0.0);
  for (std::size_t i = 0; i < level.air.size(); ++i) {
    level.air.height[i] = level.air.geopotential_height[i] = level.air.pressure_altitude[i] = 3000.0;
    level.air.pressure[i] = standard_pressure(3000.0);
  }
  EXPECT_THAT(check_layers({level}).reason, HasSubstr("no climb"));
  CheckedFlight dropouts = made(0.0);
  for (std::size_t i = 0; i < dropouts.air.size(); i += 50) dropouts.air.geopotential_height[i] = nan_value;
  EXPECT_THAT(check_layers({dropouts}).reason, HasSubstr("gap"));
}

TEST(LayersCheck, FlightWithoutHeightIsSkippedAndReported) {
  CheckedFlight without = made(0.0);
  without.air.height.clear();
  const CheckResult result = check_layers({without, made(0.0)});
  ASSERT_TRUE(result.ran);
  EXPECT_THAT(result.notes, testing::Contains(test::Says("GPS height")));
  // Pictures have a value for every record of all flights.
  for (const ReportColumn& column : result.columns)
    EXPECT_EQ(column.values.size(), 2U * 1601U) << column.name;
}

}  // namespace
}  // namespace pcor
