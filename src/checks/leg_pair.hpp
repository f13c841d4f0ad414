#pragma once

#include "numerics/least_squares.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {

/// One leg of a reverse heading, as means over it.
struct LegMean {
  Estimated tail_wind{};  ///< UXW, m/s
  double scatter = 0.0;   ///< of UXW, m/s
  /// Ground velocity to starboard of the nose, m/s; NaN: not known. Wind and sideslip make it.
  double cross_speed = nan;
  double heading = 0.0;   ///< deg
  double airspeed = nan;  ///< true, m/s
  double pressure = nan;  ///< hPa
  double mach = nan;
  double temperature = nan;  ///< ambient, K
};

/// What a pair of legs says. Errors are those of the legs' means, without changes of the wind between them.
struct LegPair {
  Estimated sum{};  ///< of the tail winds as they are, m/s: the differences in the memo's table
  /// How far the headings are from opposite, deg, from -180 to 180.
  double heading_error = 0.0;
  /// The part of the sum that the wind puts there because the headings are not opposite, m/s; 0 where the
  /// cross speeds are not known.
  double heading_share = 0.0;
  double pressure_per_airspeed = 0.0;     ///< hPa/(m/s), see there
  double temperature_per_airspeed = 0.0;  ///< how much warmer for 1 m/s more, K/(m/s): 2 T/v
  Estimated airspeed_error{};             ///< of the true airspeed, too high positive, m/s: -(sum - share)/2
  Estimated pressure_error{};             ///< the error of delta-p alone that would make it, hPa
  Estimated temperature_error{};  ///< the error of the ambient temperature alone that would make it, K
};

/// How much higher delta-p has to be for the true airspeed to be 1 m/s higher, hPa/(m/s):
///
///     -gamma M^2 p / v
///
/// at the same total pressure and the same total temperature, with gamma = 1.4: a higher static pressure is a
/// lower Mach number. Negative. From M^2 = 5 [(p_t/p)^(2/7) - 1] and T_t = T (1 + 0.2 M^2).
double pressure_per_airspeed(double pressure, double mach, double airspeed);

/// The arithmetic of a reverse heading. Both tail winds are ground speed less airspeed: the wind, opposite in
/// the two legs, cancels in their sum, and what the airspeed is too high by is in it twice, with the other
/// sign. Where headings are not quite opposite the wind does not quite cancel; the wind as both legs
/// have it is then taken out. Source: memo, Tests Using Flight Maneuvers.
LegPair pair_of(const LegMean& first, const LegMean& second);

}  // namespace pcor::internal
