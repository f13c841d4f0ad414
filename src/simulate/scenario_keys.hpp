#pragma once

#include <array>
#include <pcor/simulate/simulate.hpp>
#include <string_view>

#include "simulate/aircraft.hpp"

namespace pcor::internal::simulate {

/// Numbers of a scenario: keys, destinations and domains.

/// The values that a number may have, with its unit for the message.
struct Domain {
  double minimum;
  double maximum;
  std::string_view unit;
};

inline constexpr double unlimited = 1e9;

/// Number of a table: key, destination and domain.
template <class Object>
struct NumberKey {
  std::string_view key;
  double Object::*value;
  Domain domain;
};

inline constexpr std::array<NumberKey<Scenario>, 5> scenario_keys{{
    {"latitude", &Scenario::latitude, {-85.0, 85.0, "deg"}},
    {"longitude", &Scenario::longitude, {-180.0, 180.0, "deg"}},
    {"heading", &Scenario::heading, {0.0, 360.0, "deg"}},
    {"weight", &Scenario::weight, {10000.0, 90000.0, "kg"}},
    {"recovery_factor", &Scenario::recovery_factor, {0.0, 1.2, ""}},
}};

inline constexpr std::array<NumberKey<Scenario::Atmosphere>, 18> atmosphere_keys{{
    {"ground_pressure", &Scenario::Atmosphere::ground_pressure, {500.0, 1100.0, "hPa"}},
    {"ground_height", &Scenario::Atmosphere::ground_height, {-400.0, 5000.0, "m"}},
    {"ground_temperature", &Scenario::Atmosphere::ground_temperature, {220.0, 330.0, "K"}},
    {"lapse_rate", &Scenario::Atmosphere::lapse_rate, {-5.0, 12.0, "K/km"}},
    {"inversion_height", &Scenario::Atmosphere::inversion_height, {0.0, 20000.0, "m"}},
    {"inversion_strength", &Scenario::Atmosphere::inversion_strength, {0.0, 20.0, "K"}},
    {"tropopause", &Scenario::Atmosphere::tropopause, {5000.0, 18000.0, "m"}},
    {"ground_humidity", &Scenario::Atmosphere::ground_humidity, {0.1, 100.0, "%"}},
    {"upper_humidity", &Scenario::Atmosphere::upper_humidity, {0.1, 100.0, "%"}},
    {"wind_speed", &Scenario::Atmosphere::wind_speed, {0.0, 40.0, "m/s"}},
    {"wind_from", &Scenario::Atmosphere::wind_from, {0.0, 360.0, "deg"}},
    {"wind_shear", &Scenario::Atmosphere::wind_shear, {-5.0, 10.0, "m/s per km"}},
    {"wind_drift", &Scenario::Atmosphere::wind_drift, {0.0, 10.0, "m/s"}},
    {"wind_drift_time", &Scenario::Atmosphere::wind_drift_time, {1.0, 1e5, "s"}},
    {"turbulence", &Scenario::Atmosphere::turbulence, {1e-9, 0.1, "m2/s3"}},
    {"boundary_layer", &Scenario::Atmosphere::boundary_layer, {1e-9, 0.1, "m2/s3"}},
    {"pressure_height_east", &Scenario::Atmosphere::pressure_height_east, {-100.0, 100.0, "m per 100 km"}},
    {"pressure_height_north", &Scenario::Atmosphere::pressure_height_north, {-100.0, 100.0, "m per 100 km"}},
}};

inline constexpr std::array<NumberKey<Scenario::Cloud>, 4> cloud_keys{{
    {"base", &Scenario::Cloud::base, {-400.0, 20000.0, "m"}},
    {"top", &Scenario::Cloud::top, {-400.0, 20000.0, "m"}},
    {"liquid", &Scenario::Cloud::liquid, {0.0, 10.0, "g/m3"}},
    {"cover", &Scenario::Cloud::cover, {0.0, 1.0, ""}},
}};

inline constexpr std::array<NumberKey<Scenario::Noise>, 4> noise_keys{{
    {"rms", &Scenario::Noise::rms, {0.0, unlimited, ""}},
    {"bias", &Scenario::Noise::bias, {-unlimited, unlimited, ""}},
    {"memory", &Scenario::Noise::memory, {0.0, 1e5, "s"}},
    {"resolution", &Scenario::Noise::resolution, {0.0, unlimited, ""}},
}};

inline constexpr std::array<NumberKey<Scenario::Lams>, 6> lams_keys{{
    {"elevation", &Scenario::Lams::elevation, {-45.0, 45.0, "deg"}},
    {"azimuth", &Scenario::Lams::azimuth, {-45.0, 45.0, "deg"}},
    {"mismatch", &Scenario::Lams::mismatch, {0.0, 10.0, "m/s"}},
    {"mismatch_memory", &Scenario::Lams::mismatch_memory, {0.0, 100.0, "s"}},
    {"dropout", &Scenario::Lams::dropout, {0.0, 1.0, ""}},
    {"clear_above", &Scenario::Lams::clear_above, {0.0, 50000.0, "m"}},
}};

inline constexpr std::array<NumberKey<Scenario::Avionics>, 2> avionics_keys{{
    {"response", &Scenario::Avionics::response, {0.0, 100.0, "s"}},
    {"delay", &Scenario::Avionics::delay, {-10.0, 10.0, "s"}},
}};

inline constexpr std::array<NumberKey<Scenario::Outliers>, 2> outlier_keys{{
    {"fraction", &Scenario::Outliers::fraction, {0.0, 1.0, ""}},
    {"size", &Scenario::Outliers::size, {0.0, unlimited, ""}},
}};

inline constexpr std::array<NumberKey<Scenario::Gap>, 2> gap_keys{{
    {"start", &Scenario::Gap::start, {0.0, unlimited, "s"}},
    {"duration", &Scenario::Gap::duration, {0.0, unlimited, "s"}},
}};

/// A term of a law and the id under which a scenario has it.
struct LawKey {
  std::string_view id;
  double Scenario::Law::*value;
};

inline constexpr std::array<LawKey, 10> law_keys{{
    {"static-constant", &Scenario::Law::a0},
    {"static-alpha", &Scenario::Law::a1},
    {"static-qp", &Scenario::Law::a2},
    {"static-attack", &Scenario::Law::a3},
    {"static-alpha-quad", &Scenario::Law::a4},
    {"static-mach", &Scenario::Law::m1},
    {"static-mach2", &Scenario::Law::m2},
    {"static-mach3", &Scenario::Law::m3},
    {"static-beta-odd", &Scenario::Law::b1},
    {"static-beta-even", &Scenario::Law::b2},
}};

/// Domain of a number of a leg.
inline Domain leg_domain(std::string_view key, Scenario::Leg::Kind kind, const AircraftInfo& aircraft) {
  using Kind = Scenario::Leg::Kind;
  const bool slow = kind == Kind::take_off || kind == Kind::landing;
  if (key == "duration") return {1.0, 86400.0, "s"};
  if (key == "altitude") return {-400.0, aircraft.ceiling, "m"};
  if (key == "speed" || key == "low" || key == "high")
    return {slow ? aircraft.lift_off_speed : aircraft.min_speed, aircraft.max_speed, "m/s"};
  if (key == "rate") {
    if (kind == Kind::speed_run) return {0.05, 2.0, "m/s2"};
    return {0.5, 30.0, "m/s"};
  }
  if (key == "period") return {3.0, 120.0, "s"};
  if (key == "cycles") return {1.0, 1000.0, ""};
  if (key == "amplitude") {
    if (kind == Kind::pitch) return {0.1, 8.0, "m/s2"};
    return {0.1, 15.0, "deg"};
  }
  if (key == "roll") return {1.0, 60.0, "deg"};
  if (key == "angle") return {-3600.0, 3600.0, "deg"};
  return {0.0, 100.0, "percent"};
}

/// Domain of a parameter of an effect.
inline Domain parameter_domain(std::string_view key) {
  if (key == "tau" || key == "drying") return {0.0, 600.0, "s"};
  if (key == "seconds") return {-60.0, 60.0, "s"};
  if (key == "fraction") return {-1.0, 1.0, ""};
  if (key == "scale") return {-unlimited, unlimited, ""};
  return {-1e6, 1e6, ""};
}

}  // namespace pcor::internal::simulate
