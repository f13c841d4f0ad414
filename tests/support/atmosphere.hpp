#pragma once

#include <pcor/physics/constants.hpp>
#include <pcor/physics/moist_air.hpp>

#include <cmath>
#include <vector>

/// Dry air, standard temperature and flight envelopes for tests.
namespace atmosphere {

inline const pcor::MoistAir<double> dry = pcor::dry_air<double>();

/// ISO 2533 standard temperature, K, at the pressure `p`, hPa: lapse rate 6.5 K/km up to 226.32 hPa,
/// 216.65 K above.
inline double temperature_at_pressure(double p) {
  if (p < 226.32) return 216.65;
  return 288.15 * std::pow(p / 1013.25, pcor::constants::gas_constant_dry_air * 0.0065 / 9.80665);
}

struct FlightState {
  double p;  ///< static pressure, hPa
  double v;  ///< true airspeed, m/s
};

/// States over the envelopes of the C-130 (75 to 155 m/s, 1000 to 400 hPa) and the GV (Mach 0.35 to 0.85,
/// 1000 to 140 hPa).
inline std::vector<FlightState> envelopes() {
  std::vector<FlightState> states;
  for (double p = 1000.0; p >= 400.0; p -= 100.0) {
    for (double v = 75.0; v <= 155.0; v += 10.0) states.push_back({p, v});
  }
  for (const double p : {1000.0, 850.0, 700.0, 500.0, 350.0, 250.0, 180.0, 140.0}) {
    const double sound = std::sqrt(1.4 * pcor::constants::gas_constant_dry_air * temperature_at_pressure(p));
    for (int percent = 35; percent <= 85; percent += 5) states.push_back({p, 0.01 * percent * sound});
  }
  return states;
}

}  // namespace atmosphere
