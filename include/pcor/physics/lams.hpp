#pragma once

#include <string_view>
#include <type_traits>

#include <pcor/physics/air_data.hpp>
#include <pcor/physics/recovery_factor.hpp>

namespace pcor {

/// Cosine of the angle between the laser beam and the relative wind:
///
///     cos(theta) = cos(theta_1 + alpha) cos(theta_2 - beta)
///
/// `elevation` theta_1 above and `azimuth` theta_2 to starboard of the longitudinal axis, angle of attack
/// `attack` alpha, `sideslip` beta positive for wind from starboard; all in deg. Accuracy against the product
/// of the unit vectors: 7.5e-6 with all angles 3 deg, 6e-5 with all 5 deg, twice that where their signs are
/// unlike. Source: memo, "Effect of LAMS orientation".
template <class S>
S beam_cosine(const S& elevation, const S& azimuth, const S& attack, const S& sideslip) {
  require_scalar<S>();
  using std::cos;
  const S radians = S(constants::radians_per_degree);
  return cos(radians * (elevation + attack)) * cos(radians * (azimuth - sideslip));
}

/// Relative difference from the airspeed by the pressures beyond which a laser has lost its lock: a static
/// defect of three tenths of the dynamic pressure, larger than that of any port.
inline constexpr double max_lams_departure = 0.15;

/// Airspeed, m/s, from the speed along the beam: v = v_L / cos(theta).
template <class S>
S airspeed_from_beam(const S& beam_speed, const S& cosine) {
  require_scalar<S>();
  return beam_speed / cosine;
}

/// Correction delta-p, hPa, of a pair of measured static and dynamic pressures according to LAMS:
///
///     delta-p = (q_m - p_m chi)/(1 + chi) = (p_m + q_m)/(1 + chi) - p_m
///
/// with chi the pressure ratio of the airspeed. It is added to the static and subtracted from the dynamic
/// pressure; their sum, the total pressure, stays. Source: memo eq. 9-11 (eq. 9 lost a minus sign).
template <class S>
S static_defect_from_pressure_ratio(const S& static_pressure, const S& dynamic_pressure, const S& chi) {
  require_scalar<S>();
  return (static_pressure + dynamic_pressure) / (S(1.0) + chi) - static_pressure;
}

/// Results of LAMS for a sample.
template <class S>
struct LamsSolution {
  S static_defect = missing<S>();  ///< delta-p, hPa
  S temperature = missing<S>();    ///< corresponding ambient temperature, K
  S mach = missing<S>();           ///< Mach number, 1
};

/// The ambient temperature as the thermometer gives it, without a calibration.
struct Uncalibrated {
  template <class S>
  const S& operator()(const S& temperature) const {
    return temperature;
  }
};

/// Approach 1 of the memo: airspeed, delta-p and temperature at once.
///
/// With the airspeed known, the dynamic heating of a thermometer is known without a Mach number:
/// T = T_r - a_r v^2/(2 c_p), then chi (eq. 10) and delta-p (eq. 11). Exact in one pass for a constant
/// recovery factor in dry air; the Mach number in a_r(M) and p in e/p are found by `passes` passes, each of
/// which gains three digits or more.
///
/// `static_pressure`, `dynamic_pressure`, `vapor_pressure` hPa; `airspeed` m/s; `recovery_temperature` K;
/// `recovery` gives a_r at a Mach number. NaN in gives NaN out. Accuracy: 1e-9 hPa over the envelopes of the
/// C-130 and GV. Source: memo, "Equations for correcting", approach 1.
///
/// `calibrate` returns the calibrated temperature T_c of an ambient temperature (K), used as the temperature
/// of the air. The thermometer still measures T = T_r/(1 + a_r M^2 (gamma - 1)/2), with M = v/c(T_c): its
/// dynamic heating is the above times T/T_c, determined in the same passes.
template <class S, class Recovery, class Calibration = Uncalibrated>
LamsSolution<S> lams_simultaneous(const S& static_pressure, const S& dynamic_pressure, const S& airspeed,
                                  const S& recovery_temperature, const S& vapor_pressure,
                                  const Recovery& recovery, int passes = 4,
                                  const Calibration& calibrate = Calibration()) {
  LamsSolution<S> solution;
  S uncalibrated_share(1.0);
  MoistAir<S> air = moist_air(vapor_pressure / static_pressure);
  solution.mach = mach_number(static_pressure, dynamic_pressure, air);
  for (int pass = 0; pass < passes; ++pass) {
    S heating = airspeed * airspeed / (S(2.0) * air.specific_heat_pressure);
    if constexpr (std::is_same_v<Calibration, Uncalibrated>) {
      solution.temperature = recovery_temperature - recovery(solution.mach) * heating;
    } else {
      heating = heating * uncalibrated_share;
      const S uncalibrated = recovery_temperature - recovery(solution.mach) * heating;
      solution.temperature = calibrate(uncalibrated);
      uncalibrated_share = uncalibrated / solution.temperature;
    }
    const S chi = pressure_ratio_of_airspeed(airspeed, solution.temperature, air);
    solution.static_defect = static_defect_from_pressure_ratio(static_pressure, dynamic_pressure, chi);
    solution.mach = airspeed / speed_of_sound(solution.temperature, air);
    air = moist_air(vapor_pressure / (static_pressure + solution.static_defect));
  }
  return solution;
}

/// Approach 2 of the memo: iterate from the temperature that the measured pressures give.
///
/// Each pass takes M from the corrected pressures (eq. 7), T from the recovery temperature, chi and delta-p.
/// It converges as a_r x/(1+x) with x = M^2 (gamma-1)/2: 0.03 at M 0.39, 0.11 at M 0.79. It stops when
/// delta-p moves by less than `tolerance` hPa, or after `maximum` passes. Arguments as in
/// `lams_simultaneous`, with which it agrees.
template <class S, class Recovery, class Calibration = Uncalibrated>
LamsSolution<S> lams_iterated(const S& static_pressure, const S& dynamic_pressure, const S& airspeed,
                              const S& recovery_temperature, const S& vapor_pressure,
                              const Recovery& recovery, double tolerance = 1e-7, int maximum = 30,
                              const Calibration& calibrate = Calibration()) {
  LamsSolution<S> solution;
  solution.static_defect = S(0.0);
  for (int pass = 0; pass < maximum; ++pass) {
    const S p = static_pressure + solution.static_defect;
    const S q = dynamic_pressure - solution.static_defect;
    const MoistAir<S> air = moist_air(vapor_pressure / p);
    solution.mach = mach_number(p, q, air);
    solution.temperature =
        calibrate(ambient_temperature(recovery_temperature, solution.mach, recovery(solution.mach), air));
    const S chi = pressure_ratio_of_airspeed(airspeed, solution.temperature, air);
    const S previous = solution.static_defect;
    solution.static_defect = static_defect_from_pressure_ratio(static_pressure, dynamic_pressure, chi);
    const S step = solution.static_defect - previous;
    if (all(!(step * step > S(tolerance * tolerance)))) break;
  }
  return solution;
}

/// Approach 3 of the memo: with an ambient `temperature` (K) measured without any pressure, such as a
/// radiometer's. Passes and accuracy as of approach 1.
template <class S>
LamsSolution<S> lams_with_temperature(const S& static_pressure, const S& dynamic_pressure, const S& airspeed,
                                      const S& temperature, const S& vapor_pressure, int passes = 4) {
  LamsSolution<S> solution;
  solution.temperature = temperature;
  MoistAir<S> air = moist_air(vapor_pressure / static_pressure);
  for (int pass = 0; pass < passes; ++pass) {
    const S chi = pressure_ratio_of_airspeed(airspeed, temperature, air);
    solution.static_defect = static_defect_from_pressure_ratio(static_pressure, dynamic_pressure, chi);
    air = moist_air(vapor_pressure / (static_pressure + solution.static_defect));
  }
  solution.mach = airspeed / speed_of_sound(temperature, air);
  return solution;
}

/// Why there is no approach 4, the temperature from LAMS itself (eq. 12): it is an identity. For any delta-p,
/// eq. 7 and eq. 12 give v^2/(2 c_p T) = ((p+q)/(p+delta-p))^(R_a/c_p) - 1, and eq. 11 returns that same
/// delta-p. The airspeed cancels, so every value is a solution.
inline constexpr std::string_view approach_4_refusal =
    "approach 4 of Cooper (2012) is an identity: a temperature computed from the airspeed and the Mach "
    "number (eq. 12) makes eq. 11 return any assumed delta-p, without information; use approach 1 "
    "(recovery temperature) or approach 3 (an ambient temperature measured without any pressure)";

/// Temperature, K, from airspeed (m/s) and Mach number, without a thermometer: T = v^2/(gamma R_a M^2).
///
/// The Mach number must come from parameterised corrections: with delta-p from the same LAMS sample the
/// result is the thermometer's own value again. M = 0 gives NaN. Source: memo eq. 12.
template <class S>
S lams_temperature(const S& airspeed, const S& mach, const MoistAir<S>& air) {
  const S temperature = airspeed * airspeed / (air.heat_capacity_ratio * air.gas_constant * mach * mach);
  return select(mach > S(0.0), temperature, missing<S>());
}

}  // namespace pcor
