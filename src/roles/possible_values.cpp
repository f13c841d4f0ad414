#include "roles/possible_values.hpp"

namespace pcor::internal {
namespace {

/// Between which a series lies on whatever aircraft, in its unit.
struct Limits {
  std::string_view series;
  double least;
  double greatest;
};

// So wide that no flight is hurt: what lies outside is the mark of a missing value that the file does not
// name, a dead sensor, or another unit.
constexpr Limits all_limits[] = {
    {"static_pressure", 10, 1200},
    {"dynamic_pressure", -200, 1200},
    {"recovery_temperature", 123, 473},
    {"ambient_temperature", 123, 373},
    {"vapor_pressure", -50, 300},
    {"dew_point", 100, 373},
    {"frost_point", 100, 373},
    {"radome_dynamic_pressure", -200, 1200},
    {"attack_differential_pressure", -500, 500},
    {"sideslip_differential_pressure", -500, 500},
    {"attack", -180, 180},
    {"sideslip", -180, 180},
    {"lams_airspeed", -1000, 1000},
    {"mach", -5, 5},
    {"true_airspeed", -1500, 1500},
    {"altitude", -2000, 50000},
    {"vertical_speed", -500, 500},
    {"latitude", -90.1, 90.1},
    {"pitch", -360, 360},
    {"roll", -360, 360},
    {"heading", -720, 720},
    {"ground_speed", -1500, 1500},
    {"ground_track", -720, 720},
    {"normal_acceleration", -500, 500},
    {"longitudinal_acceleration", -500, 500},
    {"flaps", -1000, 1000},
    {"engine_torque", -1000, 10000},
    {"height_above_ground", -5000, 50000},
    {"liquid_water", -100, 1000},
    {"transducer_temperature", 123, 473},
    {"cabin_pressure", 10, 1200},
    {"other_altitude", -2000, 50000},
    {"longitude", -720, 720},
    {"ground_speed_east", -1500, 1500},
    {"ground_speed_north", -1500, 1500},
};

}  // namespace

UnitConversion possible_values(const UnitConversion& conversion, std::string_view series) {
  for (const Limits& limits : all_limits) {
    if (limits.series == series) return conversion.within(limits.least, limits.greatest);
  }
  return conversion;
}

}  // namespace pcor::internal
