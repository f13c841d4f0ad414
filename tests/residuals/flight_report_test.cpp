#include "residuals/flight_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace pcor::internal {
namespace {

using testing::ElementsAre;
using testing::IsNan;

std::shared_ptr<const FlightSamples> flight_named(const std::string& name, double start) {
  FlightSamples samples;
  samples.name = name;
  samples.time = {start, start + 1.0, start + 2.0};
  samples.motion.airspeed = {101.0, 102.0, 103.0};
  samples.intervals = {{Regime::climb, start, start + 1.0}, {Regime::turn, start + 2.0, start + 3.0}};
  return std::make_shared<const FlightSamples>(samples);
}

struct Residual {
  std::shared_ptr<const FlightSamples> samples;
  std::vector<double> values;
};

TEST(FlightReport, HasShownRecordsAndTheirIntervals) {
  FlightReport report;
  report.add_flight(flight_named("rf01", 100.0), {1, 2});
  report.add_flight(flight_named("rf02", 200.0), {0});
  EXPECT_THAT(report.report().time, ElementsAre(101.0, 102.0, 200.0));
  EXPECT_THAT(report.report().flight_starts, ElementsAre(0U, 2U));
  EXPECT_THAT(report.report().flight_names, ElementsAre("rf01", "rf02"));
  ASSERT_EQ(report.report().intervals.size(), 2U);
  EXPECT_EQ(report.report().intervals[0].name, "turn");
  EXPECT_EQ(report.report().intervals[1].name, "climb");
  EXPECT_TRUE(report.add_motion("true_airspeed"));
  EXPECT_THAT(report.report().columns.back().values, ElementsAre(102.0, 103.0, 101.0));
  EXPECT_FALSE(report.add_motion("roll"));
  EXPECT_EQ(report.report().columns.size(), 1U);
}

TEST(FlightReport, SeriesOfAnotherFlightIsNotShown) {
  FlightReport report;
  report.add_flight(flight_named("rf01", 100.0), {0, 2});
  report.add_flight(flight_named("rf02", 200.0), {0, 2});
  const std::vector<Residual> residuals{{nullptr, {}},
                                        {flight_named("rf00", 100.0), {9.0, 9.0, 9.0}},
                                        {flight_named("rf02", 900.0), {9.0, 9.0, 9.0}},
                                        {flight_named("rf02", 200.0), {1.0, 2.0, 3.0}}};
  EXPECT_TRUE(report.add_column("residual", "residual", "hPa", residuals, &Residual::values));
  EXPECT_THAT(report.report().columns.back().values, ElementsAre(IsNan(), IsNan(), 1.0, 3.0));
}

// Simulated flights in two folders may have equal names and times.
TEST(FlightReport, FlightsWithEqualNamesAndTimesKeepTheirOrder) {
  FlightReport report;
  report.add_flight(flight_named("flight", 100.0), {});
  report.add_flight(flight_named("flight", 100.0), {0});
  const std::vector<Residual> residuals{{flight_named("flight", 100.0), {1.0, 1.0, 1.0}},
                                        {flight_named("flight", 100.0), {2.0, 2.0, 2.0}}};
  EXPECT_THAT(report.report().flight_names, ElementsAre("flight"));
  EXPECT_THAT(report.joined(residuals, &Residual::values), ElementsAre(2.0));
}

}  // namespace
}  // namespace pcor::internal
