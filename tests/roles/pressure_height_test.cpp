#include "roles/pressure_height.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include <pcor/physics/standard_atmosphere.hpp>
#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

namespace pcor::internal {
namespace {

using Kind = HeightEvidence::Kind;

/// A climb from 900 to 800 hPa, in hPa.
std::vector<double> climb_pressures() {
  std::vector<double> all;
  for (int i = 0; i < 500; ++i) all.push_back(900.0 - 0.2 * i);
  return all;
}

TEST(PressureHeight, PressureAltitudeIsDetected) {
  std::vector<double> height;
  for (const double pressure : climb_pressures()) height.push_back(pressure_altitude(pressure));
  EXPECT_EQ(compare_height(height, climb_pressures()).kind, Kind::pressure_altitude);
  // In steps of 10 ft, whose rounding is 0.1 hPa rms.
  for (double& each : height) each = 3.048 * std::round(each / 3.048);
  EXPECT_EQ(compare_height(height, climb_pressures()).kind, Kind::pressure_altitude);
}

TEST(PressureHeight, NonstandardWeatherIndicatesGpsHeight) {
  std::vector<double> height;
  // A high of 5 hPa adds 45 m, and air 3 % warmer than the standard adds 30 to 60 m: 7 to 10 hPa together.
  for (const double pressure : climb_pressures()) height.push_back(1.03 * pressure_altitude(pressure - 5.0));
  EXPECT_EQ(compare_height(height, climb_pressures()).kind, Kind::gps);
}

TEST(PressureHeight, SlopeShowsAWrongUnit) {
  std::vector<double> height;
  for (const double pressure : climb_pressures()) height.push_back(1.03 * pressure_altitude(pressure - 5.0));
  const auto problem_of_scaled = [&](double factor) {
    std::vector<double> scaled = height;
    for (double& each : scaled) each *= factor;
    return compare_height(scaled, climb_pressures()).slope_problem("GGALT");
  };
  EXPECT_EQ(problem_of_scaled(1.0), "");
  EXPECT_THAT(problem_of_scaled(1.0 / 0.3048), testing::HasSubstr("altitude = \"ft\""));
  EXPECT_THAT(problem_of_scaled(0.3048), testing::HasSubstr("altitude = \"m\""));
  EXPECT_THAT(problem_of_scaled(2.0), testing::HasSubstr("impossible"));
  height.resize(100);  // a climb of 200 m does not determine a slope
  EXPECT_EQ(problem_of_scaled(2.0), "");
}

TEST(PressureHeight, SpikesOfThePressureDoNotDetermineTheSlope) {
  std::vector<double> height;
  std::vector<double> pressure;
  for (int i = 0; i < 900; ++i) {
    height.push_back(2000.0 + i % 10);
    pressure.push_back(i % 100 == 0 ? 700.0 : standard_pressure(height.back()) + 5.0);
  }
  EXPECT_EQ(compare_height(height, pressure).slope_problem("GGALT"), "");
}

TEST(PressureHeight, CancellingPressureAndTemperatureAreUndecided) {
  std::vector<double> height;
  // A low of 5 hPa subtracts 45 m, warm air adds 30 to 60 m: 0.6 hPa remain, with a scatter of 1.0 hPa.
  for (const double pressure : climb_pressures()) height.push_back(1.03 * pressure_altitude(pressure + 5.0));
  EXPECT_EQ(compare_height(height, climb_pressures()).kind, Kind::undecided);
}

TEST(PressureHeight, HeightFromAnotherPressureIsUndecided) {
  std::vector<double> height;
  // A correction of 1.5 hPa, which changes by 1 hPa.
  for (const double pressure : climb_pressures())
    height.push_back(pressure_altitude(pressure + 1.0 + 0.01 * (900.0 - pressure)));
  EXPECT_EQ(compare_height(height, climb_pressures()).kind, Kind::undecided);
}

TEST(PressureHeight, PressuresAreReadInTheUnitThatTheModelStates) {
  const test::TemporaryDirectory folder;
  std::vector<double> pascals;
  std::vector<double> height;
  for (const double pressure : climb_pressures()) {
    pascals.push_back(100.0 * pressure);
    height.push_back(pressure_altitude(pressure));
  }
  {
    test::NetcdfMaker maker(folder.path() / "flight.nc");
    maker.time(test::sequence(0, 500));
    maker.series("PSFD", "", pascals);
  }
  const Flight flight(folder.path() / "flight.nc");
  ModelDefinition model;
  model.variables[Quantity::static_pressure] = "PSFD";
  model.units[Quantity::static_pressure] = "Pa";
  const std::vector<StatedPressure> found = static_pressures_of(flight, model);
  ASSERT_EQ(found.size(), 1);
  EXPECT_EQ(found[0].unit, "Pa");
  EXPECT_EQ(height_evidence(flight, height, found).kind, Kind::pressure_altitude);
}

TEST(PressureHeight, TooFewValuesDefaultToGps) {
  EXPECT_EQ(compare_height({100.0}, {1000.0}).kind, Kind::gps);
  EXPECT_EQ(compare_height({}, {}).kind, Kind::gps);
}

}  // namespace
}  // namespace pcor::internal
