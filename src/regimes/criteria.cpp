#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include <pcor/regimes/regimes.hpp>

namespace pcor {
namespace {

/// Common part of the criteria of pitch and yaw manoeuvres, for the oscillating angle.
std::string oscillation(const char* angle, double shortest, double longest, double variance, double time,
                        const std::string& seen, const RegimeCriteria& c) {
  return fmt::format(
      "{} oscillates with a period of {} to {} s (autocorrelation {} one period later) and a variance above "
      "{} deg2 for {} s or longer, and {}, without net climb ({} m/s) or roll ({} deg)",
      angle, shortest, longest, c.periodicity, variance, time, seen, c.manoeuvre_climb, c.manoeuvre_roll);
}

std::string climb(const char* direction, double rate, const RegimeCriteria& c) {
  return fmt::format("vertical speed {} {} m/s, smoothed twice over {} s, for {} s or longer", direction,
                     rate, c.climb_smoothing, c.phase_time);
}

struct AircraftSpeeds {
  std::string_view registration;
  RegimeCriteria (*criteria)();
  double max_flap_speed;  ///< m/s
};

constexpr AircraftSpeeds aircraft_speeds[] = {{"N130AR", RegimeCriteria::c130, 92.6},
                                              {"N677F", RegimeCriteria::gv, 113.2}};

/// Entry of the aircraft whose registration is in the text, or nullptr.
const AircraftSpeeds* speeds_of(std::string_view aircraft) {
  const auto found = std::find_if(
      std::begin(aircraft_speeds), std::end(aircraft_speeds),
      [aircraft](const auto& each) { return aircraft.find(each.registration) != std::string_view::npos; });
  return found == std::end(aircraft_speeds) ? nullptr : found;
}

}  // namespace

RegimeCriteria RegimeCriteria::c130() { return {}; }

RegimeCriteria RegimeCriteria::gv() {
  RegimeCriteria criteria;
  criteria.acceleration = 0.3;
  return criteria;
}

std::optional<RegimeCriteria> RegimeCriteria::of(std::string_view aircraft) {
  const AircraftSpeeds* const known = speeds_of(aircraft);
  return known == nullptr ? std::nullopt : std::optional(known->criteria());
}

double max_flap_speed(std::string_view aircraft) {
  const AircraftSpeeds* const known = speeds_of(aircraft);
  return (known == nullptr ? aircraft_speeds[0] : *known).max_flap_speed;
}

std::string criterion_of(Regime regime, const RegimeCriteria& c) {
  switch (regime) {
    case Regime::ground:
      return fmt::format(
          "airspeed below {} m/s, until the take-off roll ({} m/s, at most {} s earlier) and from landing on",
          c.flying_speed, c.roll_speed, c.take_off_time);
    case Regime::take_off:
      return fmt::format("start of the roll to {} m above the field, at most {} s after {} m/s were reached",
                         c.take_off_height, c.take_off_time, c.flying_speed);
    case Regime::climb:
      return climb("above", c.climb_rate, c);
    case Regime::descent:
      return climb("below", -c.climb_rate, c);
    case Regime::level:
      return "airborne, and not take-off, climb or descent";
    case Regime::turn:
      return fmt::format(
          "roll beyond {} deg to one side for {} s or longer, not counting interruptions up to {} s",
          c.turn_roll, c.turn_time, c.bridged);
    case Regime::pitch_manoeuvre:
      return oscillation("pitch", c.pitch_shortest_period, c.pitch_longest_period, c.pitch_variance,
                         c.pitch_time,
                         fmt::format("the vertical speed with it ({} m/s rms)", c.pitch_vertical_speed), c);
    case Regime::yaw_manoeuvre:
      return oscillation("sideslip", c.yaw_shortest_period, c.yaw_longest_period, c.yaw_variance, c.yaw_time,
                         fmt::format("the heading with it (correlation {})", c.yaw_heading_correlation), c);
    case Regime::speed_run:
      return fmt::format(
          "airspeed changes by {} m/s2 over {} s, by {} m/s or more in all, within {} m of one height; "
          "further branches (over {} s) up to {} s apart belong to it",
          c.acceleration, c.acceleration_time, c.speed_range, c.speed_run_height, c.branch_time,
          c.speed_run_pause);
    case Regime::reverse_heading:
      return fmt::format(
          "two straight legs (roll below {} deg) of {} to {} min within {} m of height, with headings 180 "
          "deg apart (to {} deg), at most {} min after one another",
          c.leg_roll, c.leg_shortest / 60.0, c.leg_longest / 60.0, c.leg_height_range, c.leg_heading,
          c.turn_longest / 60.0);
    case Regime::circle:
      return fmt::format(
          "roll beyond {} deg to one side and steady to {} deg through {} deg of heading or more",
          c.circle_roll, c.circle_steadiness, c.circle_heading);
    case Regime::cloud:
      return fmt::format("liquid water {} g/m3 or more", c.cloud_liquid_water);
    case Regime::count:
      break;
  }
  return "";
}

}  // namespace pcor
