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
/// @param roll deg, between -90 and 90, not checked: beyond, the result is below zero
/// NaN if one is NaN. Small angles of climb: n is too small by their cosine. Source: the balance of
/// forces.
template <class S>
S load_factor(const S& vertical_acceleration, const S& roll) {
  require_scalar<S>();
  using std::cos;
  return (S(1.0) + vertical_acceleration * S(1.0 / constants::standard_gravity)) /
         cos(roll * S(constants::radians_per_degree));
}

}  // namespace pcor
