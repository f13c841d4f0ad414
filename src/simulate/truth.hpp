#pragma once

#include <array>
#include <string_view>
#include <vector>

namespace pcor::internal::simulate {

/// Everything is simulated at this rate, samples a second.
inline constexpr int internal_rate = 25;
inline constexpr double time_step = 1.0 / internal_rate;  // s

/// Values at the internal rate, one for each step of the flight.
using Series = std::vector<double>;

/// True values at every step. Angles are unwrapped beyond 360 deg, so that means are simple.
struct Truth {
  Series pressure;              ///< pressure of the undisturbed air, hPa
  Series total_pressure;        ///< hPa
  Series temperature;           ///< K
  Series vapor_pressure;        ///< hPa
  Series airspeed;              ///< m/s, gusts included
  Series mach;                  ///< 1
  Series attack;                ///< deg, gusts included
  Series sideslip;              ///< deg, positive for wind from starboard
  Series pitch;                 ///< deg
  Series roll;                  ///< deg
  Series heading;               ///< deg
  Series track;                 ///< deg
  Series ground_speed;          ///< m/s
  Series altitude;              ///< m
  Series vertical_speed;        ///< m/s
  Series latitude;              ///< deg
  Series longitude;             ///< deg
  Series height;                ///< above the ground, m
  Series normal_acceleration;   ///< acceleration without gravity, upwards in the aircraft, m/s2
  Series forward_acceleration;  ///< along the aircraft, with gravity: what an accelerometer shows, m/s2
  Series flaps;                 ///< percent
  Series liquid_water;          ///< g/m3
  Series cabin_pressure;        ///< hPa
  Series torque;                ///< torque of the engines, percent
  Series bay_temperature;       ///< temperature of the transducers, K
  Series weight;                ///< kg
  Series wind_east;             ///< direction of the air motion: eastward, m/s
  Series wind_north;            ///< m/s
  Series dissipation;           ///< dissipation rate of the turbulence, m2/s3
  Series hidden;                ///< slow wave that is not recorded in the file, rms 1

  std::size_t size() const { return pressure.size(); }
};

/// A series of the truth and how the file calls it.
struct TruthInfo {
  std::string_view recorded;  ///< name as recorded by an instrument, e.g. "ENGTRQ"; empty if not recorded
  std::string_view name;      ///< name of the true value, e.g. "TRUE_PS"; empty if it is not written
  std::string_view unit;      ///< unit in the file; degC for a series in K
  std::string_view description;
  Series Truth::*series;
  bool fast = false;   ///< written at the scenario's rate
  bool angle = false;  ///< brought to 0..360 deg
};

inline constexpr std::array<TruthInfo, 30> truth_info{{
    {"", "TRUE_PS", "hPa", "static pressure", &Truth::pressure, true},
    {"", "TRUE_PT", "hPa", "total pressure", &Truth::total_pressure, true},
    {"", "TRUE_AT", "degC", "ambient temperature", &Truth::temperature, true},
    {"", "TRUE_EW", "hPa", "water vapour pressure", &Truth::vapor_pressure, true},
    {"TASX", "TRUE_TAS", "m/s", "true airspeed", &Truth::airspeed, true},
    {"", "TRUE_MACH", "1", "Mach number", &Truth::mach, true},
    {"", "TRUE_ALPHA", "degree", "angle of attack", &Truth::attack, true},
    {"", "TRUE_BETA", "degree", "sideslip, wind from starboard positive", &Truth::sideslip, true},
    {"PITCH", "", "degree", "pitch", &Truth::pitch, true},
    {"ROLL", "", "degree", "roll", &Truth::roll, true},
    {"THDG", "", "degree", "true heading", &Truth::heading, true, true},
    {"GGTRK", "", "degree", "GPS ground track", &Truth::track, false, true},
    {"GGSPD", "", "m/s", "GPS ground speed", &Truth::ground_speed},
    {"GGALT", "TRUE_ALT", "m", "height", &Truth::altitude},
    {"RALT", "", "m", "radio altimeter, height above the ground", &Truth::height},
    {"GGVSPD", "TRUE_VSPD", "m/s", "vertical speed", &Truth::vertical_speed},
    {"GGLAT", "", "degree_N", "GPS latitude", &Truth::latitude},
    {"GGLON", "", "degree_E", "GPS longitude", &Truth::longitude},
    {"BNORMA", "TRUE_NORMA", "m/s2", "body normal acceleration less gravity", &Truth::normal_acceleration,
     true},
    {"BLONA", "", "m/s2", "body longitudinal acceleration, with gravity", &Truth::forward_acceleration, true},
    {"FLAPS", "", "percent", "flap position", &Truth::flaps},
    {"PLWCC", "TRUE_LWC", "gram/m3", "liquid water content", &Truth::liquid_water},
    {"PCAB", "", "hPa", "cabin pressure", &Truth::cabin_pressure},
    {"ENGTRQ", "", "percent", "engine torque", &Truth::torque},
    {"TBAY", "", "degC", "temperature of the pressure transducers", &Truth::bay_temperature},
    {"", "TRUE_WEIGHT", "kg", "weight of the aircraft", &Truth::weight},
    {"", "TRUE_UE", "m/s", "wind, eastward component", &Truth::wind_east, true},
    {"", "TRUE_UN", "m/s", "wind, northward component", &Truth::wind_north, true},
    {"", "TRUE_EDR", "m2/s3", "dissipation rate of turbulence", &Truth::dissipation},
    {"", "TRUE_HIDDEN", "1", "a slow wave that no instrument records", &Truth::hidden},
}};

}  // namespace pcor::internal::simulate
