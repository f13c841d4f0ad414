#pragma once

#include <pcor/model/quantity.hpp>

/// Range of a quantity in flight, in its unit.
struct InputRange {
  double lower;
  double upper;
};

inline InputRange input_range(pcor::Quantity quantity) {
  using pcor::Quantity;
  switch (quantity) {
    case Quantity::static_pressure:
      return {150, 1000};
    case Quantity::dynamic_pressure:
      return {20, 160};
    case Quantity::recovery_temperature:
    case Quantity::ambient_temperature:
      return {220, 310};
    case Quantity::vapor_pressure:
      return {0.01, 30};
    case Quantity::lams_airspeed:
      return {80, 250};
    case Quantity::mach:
      return {0.2, 0.9};
    case Quantity::dynamic_ratio:
      return {0.02, 0.5};
    case Quantity::attack_ratio:
    case Quantity::sideslip_ratio:
      return {-0.5, 0.5};
    case Quantity::flaps:
    case Quantity::engine_torque:
      return {0, 100};
    case Quantity::height_above_ground:
      return {0, 200};
    case Quantity::liquid_water:
      return {0, 0.2};
    case Quantity::wetness:
      return {0, 1};
    case Quantity::transducer_temperature:
      return {270, 320};
    case Quantity::cabin_pressure:
      return {700, 1000};
    case Quantity::date:
      return {0, 10000};
    case Quantity::time:
      return {0, 30000};
    case Quantity::static_pressure_rate:
    case Quantity::dynamic_pressure_rate:
    case Quantity::recovery_temperature_rate:
    case Quantity::ambient_temperature_rate:
    case Quantity::airspeed_rate:
      return {-2, 2};
    default:  // angles, accelerations
      return {-8, 8};
  }
}
