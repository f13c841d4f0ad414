#include <gmock/gmock.h>
#include <pcor/residuals/reference.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/isothermal_air.hpp"

using pcor::Quantity;

namespace {

constexpr double airspeed = 130.0;    // m/s
constexpr double east_wind = 12.0;    // m/s, towards the east
constexpr double north_wind = -20.0;  // m/s

/// Half an hour at a height, with a heading for every second.
template <class Heading>
pcor::FlightSamples flight(const Heading& heading_at) {
  pcor::FlightSamples flight =
      made::air_flight(std::vector<double>(1800, 3000.0), std::vector<double>(1800, airspeed));
  std::vector<double> heading;
  std::vector<double> along;
  for (int i = 0; i < 1800; ++i) {
    heading.push_back(heading_at(i));
    const double angle = heading.back() * pcor::constants::radians_per_degree;
    along.push_back(airspeed + east_wind * std::sin(angle) + north_wind * std::cos(angle));
  }
  flight.reference.columns = {{Quantity::heading, heading}, {Quantity::ground_speed, along}};
  return flight;
}

/// A turn every three minutes, and legs up and down.
double circles(int second) { return std::fmod(2.0 * second, 360.0); }
double legs(int second) { return second % 600 < 300 ? 40.0 : 220.0; }
double straight(int) { return 40.0; }

std::vector<double> residuals(const pcor::FlightSamples& flight, const pcor::ModelFile& model) {
  return made::residuals_of(flight, model, *pcor::wind_reference(model));
}

}  // namespace

TEST(Wind, ThatIsSteadyLeavesNothing) {
  // On one heading 1/900 of the wind is taken for the constant.
  for (const auto& heading : {circles, legs, straight}) {
    for (const double value : residuals(flight(heading), made::air_model())) ASSERT_NEAR(value, 0.0, 0.03);
  }
}

TEST(Wind, SaysByHowMuchDeltaPIsOffWhereHeadingsAreTurned) {
  // 1 hPa too much of delta-p is an airspeed too small by dV/dp; to second order of 1 hPa in 75.
  const pcor::ModelFile model = made::air_model({{"static-constant", 1.0 / 674.2}});
  for (const auto& heading : {circles, legs}) {
    const std::vector<double> left = residuals(flight(heading), model);
    for (const std::size_t i : {500U, 900U, 1290U}) EXPECT_NEAR(left[i], -1.0, 0.05) << i;
  }
}

TEST(Wind, SaysNothingOnOneHeading) {
  const pcor::ModelFile model = made::air_model({{"static-constant", 1.0 / 674.2}});
  for (const double value : residuals(flight(straight), model)) ASSERT_NEAR(value, 0.0, 0.03);
}

TEST(Wind, HasTheDerivativesOfItsResiduals) {
  const pcor::ModelFile model = made::air_model({{"static-constant", 0.001}});
  // Centred differences of a step of 1e-6 of p, some 7e-4 hPa, are right to 1e-5.
  EXPECT_LT(made::derivative_error(flight(circles), model, *pcor::wind_reference(model), 1e-6), 1e-4);
}

TEST(Wind, LooksAtTheAirAlone) {
  pcor::FlightSamples parked = flight(legs);
  std::fill_n(parked.motion.airspeed.begin(), 300, 5.0);
  const std::vector<double> left = residuals(parked, made::air_model());
  EXPECT_TRUE(std::isnan(left[299]));
  EXPECT_NEAR(left[300], 0.0, 0.03) << "and what was recorded there does not matter afterwards";
}
