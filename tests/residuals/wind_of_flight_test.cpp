#include "residuals/report_flight.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include <pcor/physics/constants.hpp>

namespace pcor {
namespace {

// On a circle with the wind from 250 degrees at 12 m/s, and 3 degrees of sideslip.
TEST(WindOfFlight, RecoversTheTrueWind) {
  const double east = 12.0 * std::sin(70.0 * constants::radians_per_degree);
  const double north = 12.0 * std::cos(70.0 * constants::radians_per_degree);
  FlightSamples flight;
  for (std::size_t i = 0; i < 400; ++i) {
    const double heading = static_cast<double>(i);
    const double ahead = (heading + 3.0) * constants::radians_per_degree;
    const double to_east = 130.0 * std::sin(ahead) + east, to_north = 130.0 * std::cos(ahead) + north;
    flight.time.push_back(1e9 + 10.0 * static_cast<double>(i));
    flight.motion.airspeed.push_back(130.0);
    flight.motion.heading.push_back(heading);
    flight.motion.sideslip.push_back(3.0);
    flight.motion.ground_speed.push_back(std::hypot(to_east, to_north));
    flight.motion.ground_track.push_back(std::atan2(to_east, to_north) / constants::radians_per_degree);
  }
  const std::vector<ReportBarb> wind = internal::wind_of(flight);
  EXPECT_GE(wind.size(), 39U);
  EXPECT_LE(wind.size(), 41U);
  for (const ReportBarb& barb : wind) {
    EXPECT_NEAR(barb.east, east, 1e-9);  // what rounding leaves of 130 m/s
    EXPECT_NEAR(barb.north, north, 1e-9);
  }
  flight.motion.heading.clear();
  EXPECT_TRUE(internal::wind_of(flight).empty());
}

}  // namespace
}  // namespace pcor
