#include "temperature/height_record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <pcor/base/error.hpp>
#include "support/error_of.hpp"
#include "temperature/synthetic_records.hpp"

using namespace pcor::internal;

namespace {

using made::range_of_excess;
using pcor::Error;
using pcor::test::IsError;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

HeightRecord record_of_air(const FlightAir& air, double min_climb_rate = 0.0) {
  HeightRecordOptions options;
  options.min_climb_rate = min_climb_rate;
  return height_record(air, {}, options);
}

std::optional<Error> refusal(const FlightAir& air) {
  return pcor::test::error_of([&] { record_of_air(air); });
}

TEST(HeightRecord, IntegralEqualsTheClosedForm) {
  const HeightRecord record = record_of_air(made::air({}));
  EXPECT_EQ(record.segments, 1U);
  EXPECT_EQ(record.samples, 5400U);
  // The trapezium rule over 3 m errs by less than 1e-8 of the height; rounding of 5400 steps is smaller.
  EXPECT_LT(range_of_excess(record), 1e-3);
}

TEST(HeightRecord, ThermometerErrorMatchesTheColumns) {
  const HeightRecord truth = record_of_air(made::air({}));
  made::AirPlan plan;
  plan.offset = 0.5;
  plan.gain = 0.01;
  const HeightRecord wrong = record_of_air(made::air(plan));
  // T = (T_m - offset')/(1 + gain) with t_m = t + offset + gain t: the correction that undoes it exactly.
  const double a0 = -0.5 / 1.01;
  const double a1 = -0.01 / 1.01;
  ASSERT_EQ(truth.blocks.size(), wrong.blocks.size());
  for (std::size_t i = 0; i < truth.blocks.size(); ++i) {
    const HeightBlock& block = wrong.blocks[i];
    // Exact except for rounding: the integral is linear in the coefficients.
    EXPECT_NEAR(block.excess - a0 * block.columns[0] - a1 * block.columns[1], truth.blocks[i].excess, 1e-6);
  }
}

TEST(HeightRecord, StaticPressureErrorMatchesTheFiniteDifference) {
  FlightAir air = made::air({});
  const HeightRecord truth = record_of_air(air);
  for (double& p : air.pressure) p += 0.1;
  const HeightRecord wrong = record_of_air(air);
  for (std::size_t i = 0; i < truth.blocks.size(); ++i) {
    // To first order in 0.1 hPa, which is 1e-4 to 2e-4 of the pressure, of at most 0.8 m.
    EXPECT_NEAR(wrong.blocks[i].excess - truth.blocks[i].excess, 0.1 * truth.blocks[i].columns[lasting],
                3e-4);
  }
}

TEST(HeightRecord, HumidityErrorMatchesTheFiniteDifference) {
  FlightAir air = made::air({});
  const double dry = pcor::dry_air<double>().gas_constant;
  // Vapour that falls with the pressure, 0.5 % of R_a at the ground, and 20 % more of it.
  const auto moist = [&](double part) {
    for (std::size_t i = 0; i < air.size(); ++i)
      air.gas_constant[i] = dry * (1.0 + part * 0.005 * std::pow(air.pressure[i] / 1000.0, 3));
    return record_of_air(air);
  };
  const HeightRecord measured = moist(1.0);
  const HeightRecord truth = moist(1.2);
  double largest = 0.0;
  for (std::size_t i = 0; i < truth.blocks.size(); ++i) {
    // The integral is linear in R_a: exact except for rounding.
    const double lacks = 0.2 * measured.blocks[i].columns[with_vapor];
    EXPECT_NEAR(measured.blocks[i].excess - truth.blocks[i].excess, lacks, 1e-6);
    largest = std::max(largest, lacks);
  }
  EXPECT_GT(largest, 1.0);  // m: 0.1 % of 2 km
}

TEST(HeightRecord, LawErrorsMatchTheFiniteDifferences) {
  const FlightAir right = made::air({});
  HeightRecordOptions options;
  options.recovers = true;
  const HeightRecord truth = height_record(right, {}, options);
  // The error as a part of the pressure, for about 0.1 hPa each.
  const auto part = [&right](HeightError error, std::size_t i) {
    if (error == with_dynamic) return 1e-3 * right.dynamic[i] / right.pressure[i];
    if (error == with_attack) return 1e-3 * right.attack_ratio[i];
    return 2e-4;
  };
  for (const auto& [error, size] :
       {std::pair{with_static, 2e-4}, {with_dynamic, 1e-3}, {with_attack, 1e-3}}) {
    FlightAir air = right;
    for (std::size_t i = 0; i < air.size(); ++i) {
      // The law adds to the static pressure the amount that it subtracts from the dynamic one, with the
      // total pressure unchanged; a thermometer with full recovery then shows the same for T (P/p)^(2/7).
      air.pressure[i] *= 1.0 + part(error, i);
      air.temperature[i] *= std::pow(1.0 + part(error, i), 2.0 / 7.0);
    }
    const HeightRecord wrong = height_record(air, {}, options);
    double largest = 0.0;
    for (std::size_t i = 0; i < truth.blocks.size(); ++i) {
      const double moved = wrong.blocks[i].excess - truth.blocks[i].excess;
      // To first order in 2e-4, of at most 2 m.
      EXPECT_NEAR(moved, size * truth.blocks[i].columns[error], 1e-3) << error;
      largest = std::max(largest, std::abs(moved));
    }
    EXPECT_GT(largest, 0.04) << error;  // forty times what is allowed
  }
}

TEST(HeightRecord, RestartsAfterALongGapOnly) {
  FlightAir air = made::air({});
  for (std::size_t i = 1000; i < 1005; ++i) air.pressure[i] = nan;
  EXPECT_EQ(record_of_air(air).segments, 1U);
  EXPECT_LT(range_of_excess(record_of_air(air)), 2e-3);
  for (std::size_t i = 2000; i < 2030; ++i) air.temperature[i] = nan;
  const HeightRecord record = record_of_air(air);
  EXPECT_EQ(record.segments, 2U);
  EXPECT_EQ(std::count_if(record.blocks.begin(), record.blocks.end(),
                          [](const HeightBlock& block) { return block.starts_segment; }),
            2);
}

TEST(HeightRecord, MissingHeightIsNotAGap) {
  FlightAir air = made::air({});
  for (std::size_t i = 1000; i < 1600; ++i) air.geopotential_height[i] = nan;
  const HeightRecord record = record_of_air(air);
  EXPECT_EQ(record.segments, 1U);
  EXPECT_EQ(record.missing_heights, 600U);
  EXPECT_LT(range_of_excess(record), 1e-3);
}

TEST(HeightRecord, ExcludesSpikesAndRestartsAtSteps) {
  FlightAir air = made::air({});
  for (std::size_t i = 500; i < 520; ++i) air.geopotential_height[i] += 40.0;
  for (std::size_t i = 3000; i < air.size(); ++i) air.geopotential_height[i] -= 15.0;
  const HeightRecord record = record_of_air(air);
  EXPECT_EQ(record.height_spikes, 20U);
  EXPECT_EQ(record.height_steps, 1U);
  EXPECT_EQ(record.segments, 2U);
}

TEST(HeightRecord, MinimumClimbRateSelectsBlocks) {
  const HeightRecord all = record_of_air(made::air({}));
  const HeightRecord climbs = record_of_air(made::air({}), 2.0);
  EXPECT_LT(climbs.blocks.size(), all.blocks.size());
  EXPECT_GE(climbs.segments, 3U);  // three climbs and descents in one and a half periods
  for (const HeightBlock& block : climbs.blocks) EXPECT_GE(std::abs(block.climb), 2.0);
}

TEST(HeightRecord, ArchivedStepsReplacePressureAndHumidity) {
  const FlightAir air = made::air({});
  std::vector<double> steps(air.size(), nan);
  for (std::size_t i = 1; i < air.size(); ++i)
    steps[i] = -air.gas_constant[i] / 9.80665 * std::log(air.pressure[i] / air.pressure[i - 1]);
  const HeightRecord direct = record_of_air(air);
  const HeightRecord archived = height_record(air, steps, {});
  ASSERT_EQ(direct.blocks.size(), archived.blocks.size());
  for (std::size_t i = 0; i < direct.blocks.size(); ++i)
    EXPECT_NEAR(direct.blocks[i].excess, archived.blocks[i].excess, 1e-6);  // rounding
}

/// The same way, for rounding of sums over 200 km.
void expect_same_way(const HeightRecord& one, const HeightRecord& other) {
  ASSERT_EQ(one.blocks.size(), other.blocks.size());
  for (std::size_t i = 0; i < one.blocks.size(); ++i) {
    EXPECT_NEAR(one.blocks[i].east, other.blocks[i].east, 1e-6);
    EXPECT_NEAR(one.blocks[i].north, other.blocks[i].north, 1e-6);
  }
}

TEST(HeightRecord, UsesAirspeedWithoutGroundSpeed) {
  FlightAir air = made::air({});  // flight in calm air
  const HeightRecord over_ground = record_of_air(air);
  EXPECT_EQ(over_ground.way, WayKnown::over_ground);
  air.east_speed.clear();
  air.north_speed.clear();
  const HeightRecord through_air = record_of_air(air);
  EXPECT_EQ(through_air.way, WayKnown::through_air);
  expect_same_way(through_air, over_ground);
}

TEST(HeightRecord, AirPathFillsGapsOfTheGroundPath) {
  FlightAir air = made::air({});
  const HeightRecord whole = record_of_air(air);
  EXPECT_EQ(whole.unknown_ways, 0U);
  for (std::size_t i = 2000; i < 3000; ++i) air.east_speed[i] = nan;
  const HeightRecord gap = record_of_air(air);
  EXPECT_EQ(gap.unknown_ways, 1000U);
  EXPECT_EQ(gap.way, WayKnown::over_ground);
  expect_same_way(gap, whole);
}

TEST(HeightRecord, WithoutHeadingThePathIsStraight) {
  FlightAir air = made::air({});
  air.east_speed.clear();
  air.north_speed.clear();
  auto samples = std::make_shared<pcor::FlightSamples>(*air.samples);
  samples->motion.heading.clear();
  air.samples = samples;
  const HeightRecord record = record_of_air(air);
  EXPECT_EQ(record.way, WayKnown::length);
  EXPECT_FALSE(record.returns);
  const double start = record.blocks.front().north;
  for (const HeightBlock& block : record.blocks) {
    EXPECT_EQ(block.east, 0.0);
    // 120 m/s, as it is made.
    EXPECT_NEAR(block.north - start, 120.0 * (block.time - record.blocks.front().time), 1e-3);
  }
}

TEST(HeightRecord, DetectsWhetherTheFlightReturns) {
  made::AirPlan plan;
  plan.seconds = 4500;  // three times round
  EXPECT_TRUE(record_of_air(made::air(plan)).returns);
  FlightAir through_air = made::air(plan);
  through_air.east_speed.clear();
  through_air.north_speed.clear();
  EXPECT_FALSE(record_of_air(through_air).returns);  // the wind may have taken it anywhere
  plan.turning = 1e9;                                // straight on
  EXPECT_FALSE(record_of_air(made::air(plan)).returns);
}

TEST(HeightRecord, ReportsErrorsOfTheHeight) {
  FlightAir feet = made::air({});
  feet.height_scale_problem = "GGALT: in feet";
  EXPECT_THAT(refusal(feet), IsError(Error::Code::variable, "GGALT: in feet"));

  made::AirPlan level;
  level.low = 3000.0;
  level.high = 3100.0;
  EXPECT_THAT(refusal(made::air(level)), IsError(Error::Code::samples, "100 m", "300 m"));

  FlightAir none = made::air({});
  none.height.clear();
  EXPECT_THAT(refusal(none), IsError(Error::Code::variable, "GGALT"));
  none.height_variable.clear();
  EXPECT_THAT(refusal(none), IsError(Error::Code::variable, "GPS height"));

  FlightAir cold = made::air({});
  cold.temperature.clear();
  EXPECT_THAT(refusal(cold), IsError(Error::Code::model, "recovery_temperature"));
}

TEST(HeightRecord, EmptyThermometerIsAVariableError) {
  FlightAir air = made::air({});
  std::fill(air.temperature.begin(), air.temperature.end(), nan);
  EXPECT_THAT(refusal(air), IsError(Error::Code::variable));
}

}  // namespace
