#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <netcdf>
#include <string>
#include <utility>
#include <vector>

#include "support/isothermal_air.hpp"
#include "support/says.hpp"
#include "support/short_flight.hpp"

using pcor::Quantity;

namespace {

constexpr double airspeed = 130.0;    // m/s
constexpr double east_wind = 12.0;    // m/s, towards the east
constexpr double north_wind = -20.0;  // m/s

/// Half an hour at a height, with a heading for every second.
template <class Heading>
pcor::FlightSamples flight_with_heading(const Heading& heading_at) {
  pcor::FlightSamples flight =
      made::air_flight(std::vector<double>(1800, 3000.0), std::vector<double>(1800, airspeed));
  std::vector<double> heading;
  std::vector<double> ground_speed;
  std::vector<double> track;
  for (int i = 0; i < 1800; ++i) {
    heading.push_back(heading_at(i));
    const double angle = heading.back() * pcor::constants::radians_per_degree;
    const double east = airspeed * std::sin(angle) + east_wind;
    const double north = airspeed * std::cos(angle) + north_wind;
    ground_speed.push_back(std::hypot(east, north));
    track.push_back(std::atan2(east, north) / pcor::constants::radians_per_degree);
  }
  flight.reference.columns = {
      {Quantity::heading, heading}, {Quantity::ground_speed, ground_speed}, {Quantity::ground_track, track}};
  return flight;
}

/// A turn every three minutes, and legs up and down.
double circles(int second) { return std::fmod(2.0 * second, 360.0); }
double legs(int second) { return second % 600 < 300 ? 40.0 : 220.0; }
double straight(int) { return 40.0; }

std::vector<double> wind_residuals(const pcor::FlightSamples& flight, const pcor::ModelDefinition& model) {
  return made::residuals_of(flight, model, *pcor::wind_reference(model));
}

}  // namespace

TEST(Wind, ResidualOfASteadyWindIsZero) {
  // On one heading the constant absorbs 1/900 of the wind.
  for (const auto& heading : {circles, legs, straight}) {
    for (const double value : wind_residuals(flight_with_heading(heading), made::air_model()))
      ASSERT_NEAR(value, 0.0, 0.03);
  }
}

TEST(Wind, EstimatesDeltaPErrorFromHeadingReversals) {
  // 1 hPa too much of delta-p is an airspeed too small by dV/dp; to second order of 1 hPa in 75.
  const pcor::ModelDefinition model = made::air_model({{"static-constant", 1.0 / 674.2}});
  for (const auto& heading : {circles, legs}) {
    const std::vector<double> residual = wind_residuals(flight_with_heading(heading), model);
    for (const std::size_t i : {500U, 900U, 1290U}) EXPECT_NEAR(residual[i], -1.0, 0.05) << i;
  }
}

TEST(Wind, SingleHeadingGivesNoEstimate) {
  const pcor::ModelDefinition model = made::air_model({{"static-constant", 1.0 / 674.2}});
  for (const double value : wind_residuals(flight_with_heading(straight), model))
    ASSERT_NEAR(value, 0.0, 0.03);
}

TEST(Wind, ResidualDerivativesAreCorrect) {
  const pcor::ModelDefinition model = made::air_model({{"static-constant", 0.001}});
  // Centred differences of a step of 1e-6 of p, some 7e-4 hPa, are right to 1e-5.
  EXPECT_LT(made::derivative_error(flight_with_heading(circles), model, *pcor::wind_reference(model), 1e-6),
            1e-4);
}

TEST(Wind, GroundSamplesAreNotUsed) {
  pcor::FlightSamples parked = flight_with_heading(legs);
  std::fill_n(parked.motion.airspeed.begin(), 300, 5.0);
  const std::vector<double> residual = wind_residuals(parked, made::air_model());
  EXPECT_TRUE(std::isnan(residual[299]));
  EXPECT_NEAR(residual[300], 0.0, 0.03) << "and what was recorded there does not matter afterwards";
}

TEST(Wind, FrozenSensorIsRejected) {
  for (const Quantity frozen : {Quantity::heading, Quantity::ground_speed, Quantity::ground_track}) {
    pcor::FlightSamples samples = flight_with_heading(circles);
    std::vector<double>& values = *samples.reference.find(frozen);
    std::fill_n(values.begin() + 800, 60, values[800]);
    samples.reference.frozen = {{frozen, 800, 60}};
    const pcor::ModelDefinition model = made::air_model();
    const pcor::Residuals residuals(std::make_shared<const pcor::FlightSamples>(samples), model,
                                    *pcor::wind_reference(model));
    EXPECT_EQ(residuals.mask()[799], pcor::Mask::none);
    EXPECT_EQ(residuals.mask()[800], pcor::Mask::frozen);
    EXPECT_EQ(residuals.mask()[859], pcor::Mask::frozen);
    const std::vector<double> residual = residuals.values(residuals.parameters().data());
    EXPECT_NEAR(residual[790], 0.0, 0.03) << "nor do its neighbours in the quarter of an hour";
  }
}

TEST(Wind, ReadsGroundVelocityInComponents) {
  const pcor::test::TemporaryDirectory directory;
  const std::filesystem::path path = directory / "components.nc";
  std::filesystem::copy_file(pcor::test::short_flight(), path);
  {
    netCDF::NcFile file(path.string(), netCDF::NcFile::write);
    netCDF::NcVar speed = file.getVar("GGSPD");
    netCDF::NcVar track = file.getVar("GGTRK");
    std::vector<double> east(speed.getDim(0).getSize());
    std::vector<double> north(east.size());
    speed.getVar(east.data());
    track.getVar(north.data());
    for (std::size_t i = 0; i < east.size(); ++i) {
      const double angle = north[i] * pcor::constants::radians_per_degree;
      north[i] = east[i] * std::cos(angle);
      east[i] *= std::sin(angle);
    }
    speed.putVar(east.data());
    track.putVar(north.data());
    speed.rename("GGVEW");
    track.rename("GGVNS");
    track.putAtt("units", "m/s");
  }
  const pcor::ModelDefinition model = pcor::test::laser_model();
  const auto reference = pcor::wind_reference(model);
  const pcor::FlightSamples samples = pcor::read_samples(pcor::Flight(path), model, *reference);
  EXPECT_EQ(samples.reference.variables[1].second, "GGVEW and GGVNS");
}

TEST(Wind, FrozenSensorsOfAFlightAreIdentified) {
  const pcor::test::TemporaryDirectory directory;
  const pcor::ModelDefinition model = pcor::test::laser_model();
  const auto reference = pcor::wind_reference(model);
  for (const auto& [name, quantity] :
       {std::pair("THDG", Quantity::heading), std::pair("GGSPD", Quantity::ground_speed),
        std::pair("GGTRK", Quantity::ground_track)}) {
    const std::filesystem::path path = directory / "frozen.nc";
    std::filesystem::copy_file(pcor::test::short_flight(), path,
                               std::filesystem::copy_options::overwrite_existing);
    {
      netCDF::NcFile file(path.string(), netCDF::NcFile::write);
      const netCDF::NcVar variable = file.getVar(name);
      double value = 0.0;
      variable.getVar({400}, {1}, &value);
      variable.putVar({400}, {120}, std::vector<double>(120, value).data());
    }
    const pcor::FlightSamples samples = pcor::read_samples(pcor::Flight(path), model, *reference);
    ASSERT_EQ(samples.reference.frozen.size(), 1U) << name;
    EXPECT_EQ(samples.reference.frozen[0].quantity, quantity);
    EXPECT_NEAR(static_cast<double>(samples.reference.frozen[0].count), 120.0, 2.0);
    EXPECT_THAT(samples.notes, testing::Contains(pcor::test::Says(std::string(name) + " is frozen")));
  }
}
