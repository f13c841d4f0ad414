#pragma once

#include "diagnose/manoeuvres/flown.hpp"
#include "diagnose/manoeuvres/statistics.hpp"

namespace pcor::internal::manoeuvres {

/// How an aircraft flies and what its sensors make of it, learnt from its flights. Where these do not teach a
/// number, it is the usual one of the NSF/NCAR C-130.
struct Aircraft {
  Aircraft(const Flown& flown, const Flown& with_flaps);

  Line attack{};                    ///< deg against `lift_number`
  double flaps_attack = 0.0;        ///< deg for a percent of flaps
  Line attack_ratio{};              ///< ADIFR/QCR against the angle of attack, deg
  Line sideslip_ratio{};            ///< BDIFR/QCR against the sideslip, deg
  double radome_gain = 1.0;         ///< QCR over the dynamic pressure
  double recovery_factor = 1.0;     ///< of the temperatures that `Flown` has
  double level_acceleration = 0.0;  ///< along the normal axis in level flight, m/s2
};

/// The true airspeeds, m/s, that an aircraft can have at a pressure: from a tenth above the slowest that was
/// flown at any height to a tenth above the fastest, as equivalent airspeeds too, and up to the greatest Mach
/// number that was flown. The usual one is always among them.
struct Level {
  double pressure = 0.0;  ///< hPa
  double slow = 0.0;
  double usual = 0.0;  ///< the median of what was flown within a tenth of the pressure
  double fast = 0.0;

  double range() const { return fast - slow; }
};

/// What an aircraft was seen to do.
class Envelope {
 public:
  Envelope(const Flown& flown, double step);

  Level low;
  Level middle;
  Level high;  ///< as low where the flights kept to one level
  Level fast;  ///< where the greatest Mach number was flown
  double greatest_lift_number = 0.0;
  double least_pressure = 0.0;     ///< hPa
  double greatest_pressure = 0.0;  ///< hPa

  bool has_two_levels() const { return high.pressure < low.pressure; }

  /// The speeds at a pressure, hPa.
  Level level_at(double pressure) const;

 private:
  const Flown& flown_;
  double slowest_;           // m/s
  double fastest_;           // m/s
  double least_dynamic_;     // hPa
  double greatest_dynamic_;  // hPa
  double greatest_mach_;
};

}  // namespace pcor::internal::manoeuvres
