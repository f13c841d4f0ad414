#pragma once

#include <pcor/physics/moist_air.hpp>

namespace pcor {

/// Relative temperature rise of air brought to rest, from static pressure `p` and dynamic pressure `q` (same
/// unit):
///
///     h = T*/T - 1 = ((p+q)/p)^(R_a/c_p) - 1 = M^2 (gamma - 1)/2 = v^2/(2 c_p T)
///
/// `q` is the impact pressure of compressible flow, pt - p. Result: 1, with the sign of q. Domain: p > 0;
/// anything else, and NaN in an argument, gives NaN. Source: memo eq. 5-7.
template <class S>
S dynamic_heating(const S& p, const S& q, const MoistAir<S>& air) {
  return select(p > S(0.0), power_less_one(q, p, air.poisson_exponent), missing<S>());
}

/// Mach number for a `heating` from `dynamic_heating`: M = (h 2 c_v/R_a)^(1/2). Result: 1. Domain: h >= 0;
/// anything else gives NaN. Source: memo eq. 7.
template <class S>
S mach_number_from_heating(const S& heating, const MoistAir<S>& air) {
  using std::sqrt;
  return sqrt(air.degrees_of_freedom * heating);
}

/// q/p of dry air at Mach 1, where the equations of compressible flow end: 1.2^3.5 - 1.
inline constexpr double max_dynamic_ratio = 0.892929;

/// Mach number from static pressure `p` and dynamic pressure `q` (same unit):
///
///     M = { (2 c_v/R_a) [ ((p+q)/p)^(R_a/c_p) - 1 ] }^(1/2)
///
/// Result: 1, zero or above. Domain: p > 0, q >= 0; anything else gives NaN. Above Mach 1
/// (`max_dynamic_ratio`), which is not checked, a shock stands before a pitot tube and M is too large. The
/// temperature is not needed. Accuracy for `double`: 1e-15 relative below Mach 0.847; for packs and dual
/// numbers 1e-14 at q/p = 0.1, 1e-10 at q/p = 1e-5. Source: memo eq. 7 (2 c_v/R_a, see its misprint).
template <class S>
S mach_number(const S& p, const S& q, const MoistAir<S>& air) {
  return mach_number_from_heating(dynamic_heating(p, q, air), air);
}

/// Dynamic pressure at Mach number `mach` and static pressure `p`, in the unit of `p`: the inverse of
/// `mach_number`.
///
///     q = p [ (1 + M^2 (gamma-1)/2)^(c_p/R_a) - 1 ]
///
/// Domain: p > 0, M >= 0, not checked; NaN gives NaN. Source: memo eq. 6.
template <class S>
S dynamic_pressure_from_mach(const S& p, const S& mach, const MoistAir<S>& air) {
  const S temperature_ratio = S(1.0) + mach * mach * (air.heat_capacity_ratio - S(1.0)) * S(0.5);
  return p * (power(temperature_ratio, S(1.0) / air.poisson_exponent) - S(1.0));
}

/// Ratio of dynamic to static pressure at true airspeed `airspeed` (m/s) and ambient `temperature` (K):
///
///     chi = (1 + v^2/(2 c_p T))^(c_p/R_a) - 1 = q/p
///
/// Domain: T > 0; anything else gives NaN. Result: 1. Source: memo eq. 10.
template <class S>
S pressure_ratio_of_airspeed(const S& airspeed, const S& temperature, const MoistAir<S>& air) {
  const S ratio = power_less_one(S(airspeed * airspeed), S(S(2.0) * air.specific_heat_pressure * temperature),
                                 S(S(1.0) / air.poisson_exponent));
  return select(temperature > S(0.0), ratio, missing<S>());
}

/// Dynamic pressure at static pressure `p`, true airspeed `airspeed` (m/s) and ambient `temperature` (K), in
/// the unit of `p`: q = p chi. Domain: p > 0, not checked; T > 0, anything else gives NaN. Source: memo
/// eq. 8.
template <class S>
S dynamic_pressure_from_airspeed(const S& p, const S& airspeed, const S& temperature,
                                 const MoistAir<S>& air) {
  return p * pressure_ratio_of_airspeed(airspeed, temperature, air);
}

/// Speed of sound, m/s: (gamma R_a T)^(1/2), with `temperature` T in K. Domain: T >= 0 K; anything else gives
/// NaN.
template <class S>
S speed_of_sound(const S& temperature, const MoistAir<S>& air) {
  using std::sqrt;
  return sqrt(air.heat_capacity_ratio * air.gas_constant * temperature);
}

/// True airspeed, m/s: v = M (gamma R_a T)^(1/2), with the ambient `temperature` T in K. Domain: M >= 0, not
/// checked; T >= 0 K, anything else, and NaN in an argument, gives NaN. Source: memo before eq. 6.
template <class S>
S true_airspeed(const S& mach, const S& temperature, const MoistAir<S>& air) {
  return mach * speed_of_sound(temperature, air);
}

/// True airspeed, m/s, for a `heating` h from `dynamic_heating` and the ambient `temperature` T in K:
/// v = (2 c_p T h)^(1/2). NaN if T h is below zero or NaN. Source: memo eq. 5.
template <class S>
S true_airspeed_from_heating(const S& heating, const S& temperature, const MoistAir<S>& air) {
  using std::sqrt;
  return sqrt(S(2.0) * air.specific_heat_pressure * temperature * heating);
}

}  // namespace pcor
