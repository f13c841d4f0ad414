#pragma once

#include <cmath>

#include <pcor/physics/constants.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor {

/// The load factor, lift over weight, of an aircraft that turns without sideslip:
///
///     n = (1 + a_z/g)/cos(roll)
///
/// @param vertical_acceleration a_z of the aircraft over the ground, up positive, m/s2; 0 in level flight
/// @param roll deg, less than 90
/// NaN where one is NaN. Small angles of climb: n is too small by their cosine. Source: the balance of
/// forces.
template <class S>
S load_factor(const S& vertical_acceleration, const S& roll) {
  using std::cos;
  return (S(1.0) + vertical_acceleration * S(1.0 / constants::standard_gravity)) /
         cos(roll * S(constants::radians_per_degree));
}

/// How the lift needs the angle of attack, 1/hPa:
///
///     n (1 - M^2)^(1/2)/q
///
/// With the wing as it is, the angle of attack above that without lift is this number times the weight over
/// the area and the slope of the lift (rule of Prandtl and Glauert), but for the part of q that compression
/// adds. Flaps need less of it for the same lift.
///
/// @param load_factor n @param mach below 1 @param dynamic_pressure q, hPa
/// NaN where one is NaN.
template <class S>
S lift_number(const S& load_factor, const S& mach, const S& dynamic_pressure) {
  using std::sqrt;
  return load_factor * sqrt(S(1.0) - mach * mach) / dynamic_pressure;
}

}  // namespace pcor
