#include "checks/leg_pair.hpp"

#include <cmath>

#include <pcor/physics/constants.hpp>

namespace pcor::internal {
namespace {

/// Wind from the components along the nose of a leg and to its starboard side, m/s.
struct Wind {
  double east;
  double north;
};

Wind seen_from(const LegMean& leg) {
  const double angle = leg.heading * constants::radians_per_degree;
  const double sine = std::sin(angle);
  const double cosine = std::cos(angle);
  return {leg.tail_wind.value * sine + leg.cross_speed * cosine,
          leg.tail_wind.value * cosine - leg.cross_speed * sine};
}

}  // namespace

double pressure_per_airspeed(double pressure, double mach, double airspeed) {
  constexpr double gamma = 1.4;
  return -gamma * mach * mach * pressure / airspeed;
}

LegPair pair_of(const LegMean& first, const LegMean& second) {
  LegPair pair;
  pair.sum = {first.tail_wind.value + second.tail_wind.value,
              std::hypot(first.tail_wind.error, second.tail_wind.error)};
  pair.heading_error = std::remainder(second.heading - first.heading - 180.0, 360.0);
  if (std::isfinite(first.cross_speed) && std::isfinite(second.cross_speed)) {
    const Wind a = seen_from(first);
    const Wind b = seen_from(second);
    const double one = first.heading * constants::radians_per_degree;
    const double two = second.heading * constants::radians_per_degree;
    pair.heading_share = 0.5 * (a.east + b.east) * (std::sin(one) + std::sin(two)) +
                         0.5 * (a.north + b.north) * (std::cos(one) + std::cos(two));
  }
  pair.airspeed_error = {-0.5 * (pair.sum.value - pair.heading_share), 0.5 * pair.sum.error};
  const double airspeed = 0.5 * (first.airspeed + second.airspeed);
  pair.pressure_per_airspeed = pressure_per_airspeed(0.5 * (first.pressure + second.pressure),
                                                     0.5 * (first.mach + second.mach), airspeed);
  pair.temperature_per_airspeed = (first.temperature + second.temperature) / airspeed;
  pair.pressure_error = pair.pressure_per_airspeed * pair.airspeed_error;
  pair.temperature_error = pair.temperature_per_airspeed * pair.airspeed_error;
  return pair;
}

}  // namespace pcor::internal
