#pragma once

#include <memory>
#include <vector>

#include <pcor/physics/standard_atmosphere.hpp>
#include "campaign/flight_air.hpp"

namespace pcor::test {

/// Air in memory: an aircraft that climbs and descends through the standard atmosphere with the gas constant
/// given, as if the standard's constants were its own. The thermometer is `warmer`, K.
inline internal::FlightAir standard_air(const std::vector<double>& heights, double warmer = 0.0) {
  internal::FlightAir air;
  auto samples = std::make_shared<FlightSamples>();
  samples->name = "made.nc";
  for (const double height : heights) {
    samples->time.push_back(1e9 + static_cast<double>(samples->time.size()));
    air.pressure.push_back(standard_pressure(height));
    air.temperature.push_back(standard_temperature(height) + warmer);
  }
  const std::size_t count = heights.size();
  air.height_variable = "GGALT";
  air.height = air.geopotential_height = air.pressure_altitude = heights;
  air.flying.assign(count, true);
  air.gas_constant.assign(count, 8314.32 / 28.9644);
  air.airspeed.assign(count, 100.0);
  air.east_speed.assign(count, 100.0);
  air.north_speed.assign(count, 0.0);
  air.latitude.assign(count, 45.0);
  air.d_value.assign(count, 0.0);
  air.samples = std::move(samples);
  return air;
}

}  // namespace pcor::test
