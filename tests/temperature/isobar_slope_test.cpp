#include "temperature/isobar_slope.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "support/says.hpp"
#include "temperature/synthetic_records.hpp"

using namespace pcor::internal;

namespace {

using made::range_of_excess;
using made::record_of;
using pcor::IsobarSlope;
using testing::ElementsAre;

made::AirPlan sloping() {
  made::AirPlan plan;
  plan.seconds = 10800;
  plan.turning = 5000.0;
  plan.slope_east = 1e-4;
  plan.slope_north = -5e-5;
  return plan;
}

TEST(IsobarSlope, ClimbDescentAndWholeFlightEstimateTheSlope) {
  for (const IsobarSlope option : {IsobarSlope::climb_descent, IsobarSlope::whole_flight}) {
    const Eigen::Vector2d slope = estimate_isobar_slope(record_of(sloping()), option);
    // Surfaces are crossed again within a few tens of km: the usual slope shifts the estimate by a few per
    // cent.
    EXPECT_NEAR(slope[0], 1e-4, 1e-5);
    EXPECT_NEAR(slope[1], -5e-5, 1e-5);
  }
}

TEST(IsobarSlope, LevelLegsEstimateTheSlope) {
  made::AirPlan plan = sloping();
  plan.low = 3000.0;
  plan.high = 3310.0;
  plan.period = 10800.0;  // 0.06 m/s: level, but enough of a climb to be a record
  const Eigen::Vector2d slope = estimate_isobar_slope(record_of(plan), IsobarSlope::level_legs);
  EXPECT_NEAR(slope[0], 1e-4, 1e-5);
  EXPECT_NEAR(slope[1], -5e-5, 1e-5);
}

TEST(IsobarSlope, SubtractedSlopeLeavesNoResidual) {
  HeightRecord record = record_of(sloping());
  const double before = range_of_excess(record);
  subtract_isobar_slope(record, IsobarSlope::whole_flight);
  EXPECT_LT(range_of_excess(record), 0.15 * before);
}

TEST(IsobarSlope, ModesNoneAndFittedSubtractNoSlope) {
  for (const IsobarSlope option : {IsobarSlope::none, IsobarSlope::fitted}) {
    HeightRecord record = record_of(sloping());
    const double before = range_of_excess(record);
    subtract_isobar_slope(record, option);
    EXPECT_EQ(range_of_excess(record), before);
  }
}

TEST(IsobarSlope, EveryEstimateLeavesARemainder) {
  for (const IsobarSlope option :
       {IsobarSlope::level_legs, IsobarSlope::climb_descent, IsobarSlope::whole_flight}) {
    HeightRecord record = record_of(sloping());
    subtract_isobar_slope(record, option);
    EXPECT_GT(record.slope_fraction, 0.0);
    EXPECT_LT(record.slope_fraction, 1.0);
  }
  HeightRecord record = record_of(sloping());
  subtract_isobar_slope(record, IsobarSlope::fitted);
  EXPECT_EQ(record.slope_fraction, 1.0);
}

TEST(IsobarSlope, UndeterminedSlopeIsLeftToTheLikelihood) {
  FlightAir air = made::air(sloping());
  air.east_speed.clear();
  air.north_speed.clear();
  auto samples = std::make_shared<pcor::FlightSamples>(*air.samples);
  samples->motion.heading.clear();
  air.samples = samples;
  HeightRecord no_directions = height_record(air, {}, {});
  const double before = range_of_excess(no_directions);
  subtract_isobar_slope(no_directions, IsobarSlope::whole_flight);
  EXPECT_EQ(no_directions.slope_fraction, 1.0);
  EXPECT_EQ(range_of_excess(no_directions), before);
  EXPECT_THAT(no_directions.notes,
              ElementsAre(pcor::test::Says("heading"), pcor::test::Says("--slope fitted")));
}

TEST(IsobarSlope, StraightFlightAssumesLevelCrossTrack) {
  made::AirPlan plan = sloping();
  plan.turning = 1e9;  // slope to the north only
  const Eigen::Vector2d slope = estimate_isobar_slope(record_of(plan), IsobarSlope::whole_flight);
  EXPECT_NEAR(slope[0], 0.0, 1e-9);
  EXPECT_NEAR(slope[1], -5e-5, 5e-6);
}

}  // namespace
