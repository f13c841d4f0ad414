#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include <pcor/physics/geodesy.hpp>
#include <pcor/physics/moist_air.hpp>
#include "campaign/flight_air.hpp"

/// Flights in memory through an atmosphere in closed form: temperature is linear in geopotential height, in
/// hydrostatic balance.
namespace made {

using namespace pcor::internal;

struct AirPlan {
  std::size_t seconds = 5400;
  unsigned seed = 1;
  double ground_temperature = 290.0;  ///< K
  double lapse = 6.5e-3;              ///< K/m
  double low = 1000.0;                ///< lowest and highest height, geopotential m
  double high = 6000.0;
  double period = 3600.0;   ///< s, for a climb and a descent
  double slope_east = 0.0;  ///< slope of isobars
  double slope_north = 0.0;
  double offset = 0.0;  ///< K; error of the thermometer: offset + gain t, t in degC
  double gain = 0.0;
  double gps = 0.0;         ///< noise of the GPS height, m
  double gps_memory = 0.0;  ///< s
  double turning = 1500.0;  ///< s, for a full circle
  double latitude = 40.0;   ///< deg
};

inline pcor::internal::FlightAir air(const AirPlan& plan) {
  using pcor::constants::radians_per_degree;
  const double gas_constant = pcor::dry_air<double>().gas_constant;
  constexpr double gravity = pcor::constants::standard_gravity;
  auto samples = std::make_shared<pcor::FlightSamples>();
  samples->name = "made-air-" + std::to_string(plan.seed);
  pcor::internal::FlightAir air;
  std::mt19937_64 engine(plan.seed);
  std::normal_distribution<double> normal;
  double slow = normal(engine);
  double east = 0.0;
  double north = 0.0;
  for (std::size_t i = 0; i < plan.seconds; ++i) {
    const auto t = static_cast<double>(i);
    // Triangle with round corners: climbs and descents at a constant rate.
    const double wave = std::asin(0.98 * std::sin(2.0 * M_PI * (t / plan.period - 0.25))) / std::asin(0.98);
    const double height = 0.5 * (plan.low + plan.high) + 0.5 * (plan.high - plan.low) * wave;
    const double heading = 360.0 * std::fmod(t / plan.turning, 1.0);
    const double to_east = 120.0 * std::sin(heading * radians_per_degree);
    const double to_north = 120.0 * std::cos(heading * radians_per_degree);
    // Isobars slope, so the air at `height` is that of the height `level` at the start.
    const double level = height - plan.slope_east * east - plan.slope_north * north;
    const double temperature = plan.ground_temperature - plan.lapse * level;
    const double exponent = gravity / (gas_constant * plan.lapse);
    const double shown = temperature + plan.offset + plan.gain * (temperature - pcor::constants::ice_point);
    samples->time.push_back(1321560000.0 + t);
    samples->motion.heading.push_back(heading);
    samples->motion.ground_speed.push_back(120.0);
    samples->motion.ground_track.push_back(heading);
    air.flying.push_back(true);
    air.pressure.push_back(1000.0 * std::pow(temperature / plan.ground_temperature, exponent));
    air.temperature.push_back(shown);
    // Speed 120 m/s. The angle of attack increases with height and is about 2 deg larger in climbs than in
    // descents.
    air.dynamic.push_back(0.5 * air.pressure.back() / (gas_constant * temperature) * 120.0 * 120.0);
    air.attack_ratio.push_back(-0.2 + 1e-5 * height + 0.02 * std::cos(2.0 * M_PI * (t / plan.period - 0.25)));
    air.airspeed.push_back(120.0);
    air.gas_constant.push_back(gas_constant);
    air.latitude.push_back(plan.latitude);
    const double keeps = plan.gps_memory > 0.0 ? std::exp(-1.0 / plan.gps_memory) : 0.0;
    slow = keeps * slow + std::sqrt(1.0 - keeps * keeps) * normal(engine);
    air.geopotential_height.push_back(height + plan.gps * slow);
    air.height.push_back(air.geopotential_height.back());  // the geometric height differs by at most 0.5 %
    air.east_speed.push_back(to_east);
    air.north_speed.push_back(to_north);
    east += to_east;
    north += to_north;
  }
  samples->motion.time = samples->time;
  samples->motion.airspeed = air.airspeed;
  air.height_variable = "GGALT";
  for (const double p : air.pressure)
    air.pressure_altitude.push_back(44330.8 * (1.0 - std::pow(p / 1013.25, 0.190263)));
  air.samples = std::move(samples);
  return air;
}

}  // namespace made
