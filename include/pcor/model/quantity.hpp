#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

namespace pcor {

/// Quantities that the library knows by name. The first ones, up to `date`, are recorded by the aircraft:
/// they are the roles that a model file may assign to variables. The others are derived.
enum class Quantity : std::uint8_t {
  static_pressure,
  dynamic_pressure,
  recovery_temperature,
  ambient_temperature,
  vapor_pressure,
  dew_point,
  frost_point,
  radome_dynamic_pressure,
  attack_differential_pressure,
  sideslip_differential_pressure,
  attack,
  sideslip,
  lams_airspeed,
  mach,
  true_airspeed,
  altitude,
  vertical_speed,
  latitude,
  pitch,
  roll,
  heading,
  ground_speed,
  ground_track,
  normal_acceleration,
  longitudinal_acceleration,
  flaps,
  engine_torque,
  height_above_ground,
  liquid_water,
  transducer_temperature,
  cabin_pressure,
  date,

  time,
  dynamic_ratio,
  attack_ratio,
  sideslip_ratio,
  static_pressure_rate,
  dynamic_pressure_rate,
  recovery_temperature_rate,
  ambient_temperature_rate,
  airspeed_rate,
  wetness,
  port_static_pressure,
  port_dynamic_pressure,

  static_defect,
  lams_static_defect,
  corrected_static_pressure,
  corrected_dynamic_pressure,
  humidity,
  corrected_mach,
  corrected_airspeed,
  lams_temperature,
  lams_dynamic_pressure,
  filtered_lams_temperature,
  height_step,

  static_defect_uncertainty,
  corrected_static_pressure_uncertainty,
  corrected_dynamic_pressure_uncertainty,
  ambient_temperature_uncertainty,
  corrected_airspeed_uncertainty,

  count
};

constexpr std::size_t index(Quantity quantity) { return static_cast<std::size_t>(quantity); }

inline constexpr std::size_t quantity_count = index(Quantity::count);

/// Number of roles: quantities before `time`.
inline constexpr std::size_t role_count = index(Quantity::time);

/// Maximum number of further variables in one model or loop in addition to the quantities of the library.
inline constexpr std::size_t extra_capacity = 24;

/// Number of values of a state: the element of `Quantity::count`, which is not a quantity, stays empty.
inline constexpr std::size_t state_capacity = quantity_count + 1 + extra_capacity;

/// Element of the further variable with the given index, and the inverse function.
constexpr Quantity extra_quantity(std::size_t number) {
  return static_cast<Quantity>(quantity_count + 1 + number);
}
constexpr std::size_t extra_number(Quantity quantity) { return index(quantity) - quantity_count - 1; }

/// Name, unit, description and plausible range of a quantity. The range is much wider than in any flight;
/// values outside are faults.
struct QuantityInfo {
  std::string_view name;
  std::string_view unit;
  std::string_view description;
  Quantity quantity = Quantity::count;
  double minimum = std::numeric_limits<double>::lowest();
  double maximum = std::numeric_limits<double>::max();
};

/// Metadata of every quantity, in the order of the enumeration.
inline constexpr std::array<QuantityInfo, quantity_count> quantity_info{{
    {"static_pressure", "hPa", "static pressure as measured, p_m", Quantity::static_pressure, -2000.0,
     2000.0},
    {"dynamic_pressure", "hPa", "dynamic pressure as measured, q_m", Quantity::dynamic_pressure, -2000.0,
     2000.0},
    {"recovery_temperature", "K", "temperature that a thermometer in the airstream shows, T_r",
     Quantity::recovery_temperature, 100.0, 1000.0},
    {"ambient_temperature", "K", "temperature of the undisturbed air, T", Quantity::ambient_temperature,
     100.0, 400.0},
    {"vapor_pressure", "hPa", "water vapour pressure, e", Quantity::vapor_pressure, -2000.0, 2000.0},
    {"dew_point", "K", "dew point: where the vapour would saturate over water, at any temperature",
     Quantity::dew_point, 50.0, 500.0},
    {"frost_point", "K", "temperature of a chilled mirror: over ice below the ice point, over water above",
     Quantity::frost_point, 50.0, 500.0},
    {"radome_dynamic_pressure", "hPa", "dynamic pressure at the centre of the radome, QCR",
     Quantity::radome_dynamic_pressure, -2000.0, 2000.0},
    {"attack_differential_pressure", "hPa", "vertical differential pressure of the radome, ADIFR",
     Quantity::attack_differential_pressure, -2000.0, 2000.0},
    {"sideslip_differential_pressure", "hPa", "horizontal differential pressure of the radome, BDIFR",
     Quantity::sideslip_differential_pressure, -2000.0, 2000.0},
    {"attack", "deg", "angle of attack, alpha", Quantity::attack, -180.0, 180.0},
    {"sideslip", "deg", "sideslip, beta, positive for wind from starboard", Quantity::sideslip, -180.0,
     180.0},
    {"lams_airspeed", "m/s", "airspeed along the laser beam, v_L", Quantity::lams_airspeed, -1500.0, 1500.0},
    {"mach", "1", "Mach number in the laws: an independent one, otherwise from the measured pair in dry air",
     Quantity::mach, -3.0, 3.0},
    {"true_airspeed", "m/s", "true airspeed of the recording system", Quantity::true_airspeed, -1500.0,
     1500.0},
    {"altitude", "m", "GPS altitude", Quantity::altitude, -5000.0, 100000},
    {"vertical_speed", "m/s", "vertical speed of the aircraft, up positive", Quantity::vertical_speed,
     -1500.0, 1500.0},
    {"latitude", "deg", "latitude, north positive", Quantity::latitude, -90.0, 90.0},
    {"pitch", "deg", "pitch, nose up positive", Quantity::pitch, -360.0, 360.0},
    {"roll", "deg", "roll, starboard wing down positive", Quantity::roll, -360.0, 360.0},
    {"heading", "deg", "true heading", Quantity::heading, -720.0, 720.0},
    {"ground_speed", "m/s", "ground speed", Quantity::ground_speed, -1500.0, 1500.0},
    {"ground_track", "deg", "true ground track", Quantity::ground_track, -720.0, 720.0},
    {"normal_acceleration", "m/s2", "acceleration along the normal axis, up positive, without gravity",
     Quantity::normal_acceleration, -1000.0, 1000.0},
    {"longitudinal_acceleration", "m/s2",
     "acceleration along the longitudinal axis, forward positive, as an accelerometer shows it",
     Quantity::longitudinal_acceleration, -1000.0, 1000.0},
    {"flaps", "percent", "flap position", Quantity::flaps, -1000.0, 1000.0},
    {"engine_torque", "percent", "torque of the engines", Quantity::engine_torque, -10000.0, 10000.0},
    {"height_above_ground", "m", "height above the ground", Quantity::height_above_ground, -1000, 100000},
    {"liquid_water", "g/m3", "liquid water content", Quantity::liquid_water, -1000.0, 1000.0},
    {"transducer_temperature", "K", "temperature of the pressure transducers",
     Quantity::transducer_temperature, 100.0, 1000.0},
    {"cabin_pressure", "hPa", "cabin pressure", Quantity::cabin_pressure, -2000.0, 2000.0},
    {"date", "days since 2000-01-01", "date and time of the sample, UTC", Quantity::date, -14610.0, 36525.0},

    {"time", "s", "time since the first record", Quantity::time},
    {"dynamic_ratio", "1", "dynamic over static pressure as measured, q_m/p_m", Quantity::dynamic_ratio},
    {"attack_ratio", "1", "ADIFR/QCR", Quantity::attack_ratio},
    {"sideslip_ratio", "1", "BDIFR/QCR", Quantity::sideslip_ratio},
    {"static_pressure_rate", "hPa/s", "rate of change of the measured static pressure",
     Quantity::static_pressure_rate},
    {"dynamic_pressure_rate", "hPa/s", "rate of change of the measured dynamic pressure",
     Quantity::dynamic_pressure_rate},
    {"recovery_temperature_rate", "K/s", "rate of change of the recovery temperature",
     Quantity::recovery_temperature_rate},
    {"ambient_temperature_rate", "K/s", "rate of change of the ambient temperature",
     Quantity::ambient_temperature_rate},
    {"airspeed_rate", "m/s2",
     "rate of change of the airspeed along the laser's beam, by the corrected pressures",
     Quantity::airspeed_rate},
    {"wetness", "1", "wetted fraction of the thermometer: 1 in cloud, decreasing outside (temp-wetting)",
     Quantity::wetness},
    {"port_static_pressure", "hPa", "static pressure at the port, after effects of transducer and line",
     Quantity::port_static_pressure},
    {"port_dynamic_pressure", "hPa", "dynamic pressure at the ports, after effects of transducer and line",
     Quantity::port_dynamic_pressure},

    {"static_defect", "hPa", "delta-p of the model, added to the static pressure", Quantity::static_defect},
    {"lams_static_defect", "hPa", "delta-p from LAMS", Quantity::lams_static_defect, -2000.0, 2000.0},
    {"corrected_static_pressure", "hPa", "corrected static pressure, p", Quantity::corrected_static_pressure,
     1.0, 2000.0},
    {"corrected_dynamic_pressure", "hPa", "corrected dynamic pressure, q",
     Quantity::corrected_dynamic_pressure, 0.0, 2000.0},
    {"humidity", "1", "water vapour pressure over static pressure, e/p, not above saturation",
     Quantity::humidity},
    {"corrected_mach", "1", "Mach number from the corrected pressures", Quantity::corrected_mach, 0.0, 1.0},
    {"corrected_airspeed", "m/s", "true airspeed from the corrected pressures", Quantity::corrected_airspeed,
     0.0, 1500.0},
    {"lams_temperature", "K", "ambient temperature from LAMS without a thermometer",
     Quantity::lams_temperature, 100.0, 400.0},
    {"lams_dynamic_pressure", "hPa", "dynamic pressure from LAMS", Quantity::lams_dynamic_pressure, 0.0,
     2000.0},
    {"filtered_lams_temperature", "K",
     "ambient temperature from LAMS without periods under 3 s, half a window ago",
     Quantity::filtered_lams_temperature, 100.0, 400.0},
    {"height_step", "m/K", "step of geopotential height per kelvin since the sample before",
     Quantity::height_step},

    {"static_defect_uncertainty", "hPa", "standard uncertainty of delta-p of the model",
     Quantity::static_defect_uncertainty},
    {"corrected_static_pressure_uncertainty", "hPa", "standard uncertainty of the corrected static pressure",
     Quantity::corrected_static_pressure_uncertainty},
    {"corrected_dynamic_pressure_uncertainty", "hPa",
     "standard uncertainty of the corrected dynamic pressure",
     Quantity::corrected_dynamic_pressure_uncertainty},
    {"ambient_temperature_uncertainty", "K", "standard uncertainty of the ambient temperature",
     Quantity::ambient_temperature_uncertainty},
    {"corrected_airspeed_uncertainty", "m/s", "standard uncertainty of the true airspeed",
     Quantity::corrected_airspeed_uncertainty},
}};

/// True if the index of every row equals its quantity.
constexpr bool quantity_info_is_in_order() {
  for (std::size_t i = 0; i < quantity_count; ++i) {
    if (index(quantity_info[i].quantity) != i) return false;
  }
  return true;
}
static_assert(quantity_info_is_in_order(), "quantity_info must have the order of the enumeration");

constexpr const QuantityInfo& info_of(Quantity quantity) { return quantity_info[index(quantity)]; }

/// Quantity with the given name, or `Quantity::count` if unknown.
constexpr Quantity quantity_named(std::string_view name) {
  for (std::size_t i = 0; i < quantity_count; ++i) {
    if (quantity_info[i].name == name) return static_cast<Quantity>(i);
  }
  return Quantity::count;
}

/// Rate of change computed from earlier and later samples, and the quantity that changes.
struct Rate {
  Quantity quantity;
  Quantity rate;
};

/// All such rates of recorded quantities. `airspeed_rate` is that of a result (`LookAhead`).
inline constexpr std::array<Rate, 4> rates{{
    {Quantity::static_pressure, Quantity::static_pressure_rate},
    {Quantity::dynamic_pressure, Quantity::dynamic_pressure_rate},
    {Quantity::recovery_temperature, Quantity::recovery_temperature_rate},
    {Quantity::ambient_temperature, Quantity::ambient_temperature_rate},
}};

/// Upper limit of retracted flaps, percent.
inline constexpr double flaps_in = 5.0;

constexpr bool is_role(Quantity quantity) { return index(quantity) < role_count; }

/// Recorded humidities; a model has at most one of them. The preferred one is the first.
inline constexpr std::array<Quantity, 3> humidity_roles{Quantity::vapor_pressure, Quantity::dew_point,
                                                        Quantity::frost_point};

constexpr bool is_humidity(Quantity quantity) {
  return quantity == humidity_roles[0] || quantity == humidity_roles[1] || quantity == humidity_roles[2];
}

/// Roles that `process` reads even if delta-p does not need them: temperature, humidity and laser airspeed.
constexpr bool is_always_read(Quantity quantity) {
  return is_humidity(quantity) || quantity == Quantity::recovery_temperature ||
         quantity == Quantity::ambient_temperature || quantity == Quantity::lams_airspeed;
}

}  // namespace pcor
