// The laser's temperature against the thermometer, on simulated flights.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include <pcor/simulate/simulate.hpp>
#include "checks/checks.hpp"
#include "support/data.hpp"
#include "support/says.hpp"
#include "support/temporary_directory.hpp"

using namespace pcor::internal;

namespace pcor {
namespace {

using test::scenarios;
using testing::Contains;
using testing::HasSubstr;

CheckedFlights one_flight(const std::string& more, bool with_laser = true) {
  const std::string text = R"(
format = "pcor-scenario/1"
name = "laser"
aircraft = "C-130"
start = 2011-11-17T20:00:00Z
seed = 5
[[system]]
static = "PSFD"
dynamic = "QCF"
law = { static-constant = 0.004127875, static-alpha = 0.021279816, static-qp = 0.030849643 }
[[leg]]
kind = "take-off"
altitude = 600
speed = 110
[[leg]]
kind = "level"
duration = 400
[[leg]]
kind = "climb"
altitude = 3000
[[leg]]
kind = "level"
duration = 5400
)" + more;
  const test::TemporaryDirectory directory;
  simulate_flight(parse_scenario(text, "laser.toml"), directory / "flight.nc");
  ModelDefinition model = read_model(scenarios / "models" / "c130-psfd-eq18.toml");
  if (!with_laser) model.variables.erase(Quantity::lams_airspeed);
  CheckedFlights flights(1);
  flights[0].air = read_flight_air({directory / "flight.nc"}, 0, model);
  return flights;
}

const std::string warm_thermometer = "[[effect]]\nid = \"temp-offset\"\noffset = 1.5\n";
const std::string cloud =
    "[[atmosphere.cloud]]\nbase = 2500\ntop = 3500\ncover = 0.4\n"
    "[[effect]]\nid = \"temp-wetting\"\nerror = -2.0\n";

TEST(LamsTemperatureCheck, AgreesWithoutErrors) {
  const CheckResult result = check_lams_temperature(one_flight(""));
  ASSERT_TRUE(result.was_run) << result.reason;
  EXPECT_NEAR(result.number("offset_k"), 0.0, 3.0 * result.number("offset_stderr_k"));
  EXPECT_EQ(result.verdict, CheckVerdict::consistent);
  EXPECT_THAT(result.limitations, HasSubstr("sample by sample"));
}

TEST(LamsTemperatureCheck, DetectsAWarmThermometer) {
  const CheckResult result = check_lams_temperature(one_flight(warm_thermometer));
  ASSERT_TRUE(result.was_run);
  // 1.5 K of recovery temperature are 1.5/(1 + 0.2 r M^2) K of ambient, with M = 0.33.
  EXPECT_NEAR(result.number("offset_k"), -1.47, 3.0 * result.number("offset_stderr_k") + 0.01);
  EXPECT_EQ(result.verdict, CheckVerdict::inconsistent);
}

TEST(LamsTemperatureCheck, CloudSamplesHaveASeparateOffset) {
  const CheckResult result = check_lams_temperature(one_flight(cloud));
  ASSERT_TRUE(result.was_run);
  // A thermometer that reads 2 K low when wet, and dries within 10 s.
  EXPECT_GT(result.number("cloud_offset_k"), 1.2);
  EXPECT_LT(std::abs(result.number("offset_k")), 0.5);
  EXPECT_THAT(result.notes, Contains(test::Says("suspect")));
}

TEST(LamsTemperatureCheck, NoiseIsLargerInTheBoundaryLayer) {
  const CheckResult result = check_lams_temperature(one_flight(""));
  for (const ReportTable& table : result.tables) {
    if (table.title != "Noise of the difference by period: numbers") continue;
    ASSERT_FALSE(table.rows.empty());
    EXPECT_GT(std::stod(table.rows[0][1]), 1.2 * std::stod(table.rows[0][2]));
    // Beyond the memory of the air between laser and pitot, 2 s, means over longer have less of it.
    EXPECT_LT(std::stod(table.rows[4][1]), std::stod(table.rows[2][1]));
    return;
  }
  FAIL() << "no table by period";
}

TEST(LamsTemperatureCheck, FlightsOfAnotherRecordIntervalAreNotUsed) {
  CheckedFlights flights = one_flight("");
  const CheckResult alone = check_lams_temperature(flights);
  const CheckedFlight same = flights[0];
  flights.push_back(same);
  FlightSamples coarse = *same.air.samples;
  coarse.step = 2.0;
  flights[1].air.samples = std::make_shared<FlightSamples>(std::move(coarse));
  const CheckResult result = check_lams_temperature(flights);
  for (const char* name : {"samples", "offset_k", "offset_stderr_k"})
    EXPECT_EQ(result.number(name), alone.number(name)) << name;
  EXPECT_THAT(result.notes, Contains(test::Says("1 of 2 flights are not used")));
}

TEST(LamsTemperatureCheck, IsNotRunWithoutALaser) {
  const CheckResult result = check_lams_temperature(one_flight("", false));
  EXPECT_FALSE(result.was_run);
  EXPECT_THAT(result.reason, HasSubstr("laser"));
}

}  // namespace
}  // namespace pcor
