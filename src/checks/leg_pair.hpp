#pragma once

#include "numerics/least_squares.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {

/// Means over one leg of a reverse heading.
struct LegMean {
  Estimate tail_wind{};  ///< UXW, m/s
  double scatter = 0.0;  ///< scatter of UXW, m/s
  /// Ground velocity to starboard of the nose, m/s, caused by wind and sideslip; NaN: not known.
  double cross_speed = nan;
  double heading = 0.0;   ///< deg
  double airspeed = nan;  ///< true, m/s
  double pressure = nan;  ///< hPa
  double mach = nan;
  double temperature = nan;  ///< ambient, K
};

/// Result of a pair of legs. Errors apply to the means of the legs, without changes of the wind between them.
struct LegPair {
  Estimate sum{};  ///< sum of the tail winds, m/s: the differences in the memo's table
  /// Deviation of the headings from opposite, deg, from -180 to 180.
  double heading_error = 0.0;
  /// Part of the sum caused by the wind because the headings are not opposite, m/s; 0 if the cross speeds are
  /// not known.
  double heading_share = 0.0;
  double pressure_per_airspeed = 0.0;     ///< hPa/(m/s), see the function pressure_per_airspeed
  double temperature_per_airspeed = 0.0;  ///< warming for 1 m/s more airspeed, K/(m/s): 2 T/v
  Estimate airspeed_error{};              ///< error of the true airspeed, too high positive, m/s: -(sum -
                                          ///< share)/2
  Estimate pressure_error{};              ///< error of delta-p alone that would cause it, hPa
  Estimate temperature_error{};           ///< error of the ambient temperature alone that would cause it, K
};

/// Increase of delta-p that raises the true airspeed by 1 m/s, hPa/(m/s):
///
///     -gamma M^2 p / v
///
/// at the same total pressure and the same total temperature, with gamma = 1.4: a higher static pressure is a
/// lower Mach number. Negative. From M^2 = 5 [(p_t/p)^(2/7) - 1] and T_t = T (1 + 0.2 M^2).
double pressure_per_airspeed(double pressure, double mach, double airspeed);

/// Evaluates a reverse heading. Both tail winds are ground speed minus airspeed: the wind, opposite in the
/// two legs, cancels in their sum, and the excess of the airspeed enters it twice, with negative sign. If the
/// headings are not exactly opposite the wind does not fully cancel; the wind from both legs is then
/// subtracted. Source: memo, Tests Using Flight Maneuvers.
LegPair pair_of(const LegMean& first, const LegMean& second);

}  // namespace pcor::internal
