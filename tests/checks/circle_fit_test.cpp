// The fit of a circle on turns made here, of which wind and errors are known.
#include "checks/circle_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include <pcor/physics/constants.hpp>

using namespace pcor::internal;

namespace pcor {
namespace {

using constants::radians_per_degree;

constexpr double east_wind = 8.0;       // m/s
constexpr double north_wind = -5.0;     // m/s
constexpr double airspeed_error = 0.9;  // m/s
constexpr double turned_too_far = 0.7;  // deg

/// One turn of `degrees` in 150 s, with noise of correlation time 2 s.
CircleFit fit_of_turn(double degrees, double noise, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> airspeed, heading, east, north, time;
  double gust_east = normal(engine);
  double gust_north = normal(engine);
  const double keep = std::exp(-0.5);
  const double kick = std::sqrt(1.0 - keep * keep);
  for (int i = 0; i < 150; ++i) {
    const double angle = degrees * i / 150.0;
    const double speed = 120.0 + 2.0 * std::sin(i / 20.0);
    time.push_back(1321560000.0 + i);
    airspeed.push_back(speed + airspeed_error);
    heading.push_back(std::remainder(angle + turned_too_far, 360.0));
    east.push_back(east_wind + noise * gust_east + speed * std::sin(angle * radians_per_degree));
    north.push_back(north_wind + noise * gust_north + speed * std::cos(angle * radians_per_degree));
    gust_east = keep * gust_east + kick * normal(engine);
    gust_north = keep * gust_north + kick * normal(engine);
  }
  return fit_circle(airspeed, heading, east, north, time, 1.0);
}

TEST(CircleFit, FindsWindAndErrors) {
  for (const double degrees : {360.0, -360.0, 310.0}) {
    SCOPED_TRACE(degrees);
    const CircleFit fit = fit_of_turn(degrees, 0.0, 1);
    // The error of the heading is small against one: its square times the airspeed is 0.02 m/s.
    EXPECT_NEAR(fit.airspeed_error.value, airspeed_error, 0.02);
    EXPECT_NEAR(fit.east_wind.value, east_wind, 0.02);
    EXPECT_NEAR(fit.north_wind.value, north_wind, 0.02);
    // It is found in the airspeed that is 0.9 m/s too high: 1 %.
    EXPECT_NEAR(fit.heading_error.value, turned_too_far, 0.01);
    EXPECT_NEAR(fit.turned, degrees * 149.0 / 150.0, 1e-6);
  }
}

TEST(CircleFit, StatedErrorsCoverTheTruth) {
  constexpr unsigned count = 300;
  unsigned within = 0;
  for (unsigned seed = 1; seed <= count; ++seed) {
    const Estimate found = fit_of_turn(360.0, 0.4, seed).airspeed_error;
    if (std::abs(found.value - airspeed_error) < 2.0 * found.error) ++within;
  }
  // Of 300 normal errors 286 +- 3.6 are within two of theirs; the noise is estimated too, from a turn of 150
  // samples, so a few more are allowed outside: 90 %.
  EXPECT_GE(within, 270U);
  EXPECT_LE(within, 299U);
}

TEST(CircleFit, WithoutATurnResultIsMissing) {
  // Without a change of heading wind and airspeed are one.
  EXPECT_TRUE(std::isnan(fit_of_turn(0.0, 0.0, 1).airspeed_error.value));
  const std::vector<double> nothing(100, std::nan(""));
  std::vector<double> time;
  for (int i = 0; i < 100; ++i) time.push_back(i);
  EXPECT_TRUE(std::isnan(fit_circle(nothing, nothing, nothing, nothing, time, 1.0).airspeed_error.value));
}

}  // namespace
}  // namespace pcor
