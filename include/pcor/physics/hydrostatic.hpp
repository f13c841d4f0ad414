#pragma once

#include <pcor/physics/constants.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor {

/// The step of geopotential height per kelvin between two pressures, m/K:
///
///     dH/T = -(R_a/g0) ln(p/p_before)
///
/// with the gas constant of the moist air between them, J/(kg K), and standard gravity. Multiplied by the
/// mean temperature of the step (K) it is the thickness; the mean of both ends is exact if R_a T is linear in
/// ln p. Positive upwards. Domain: pressures above zero in one unit; not checked: two negative pressures
/// give a number, others NaN or an infinity. Source: memo eq. 22 and 24, in the exact form: the first-order
/// form R_a dp/(g p) with the end-point pressure is short by 2 m over one scale height in 2000 steps.
template <class S>
S hydrostatic_step(const S& pressure_before, const S& pressure, const S& gas_constant) {
  require_scalar<S>();
  using std::log;
  return -(gas_constant * S(1.0 / constants::standard_gravity)) * log(S(pressure / pressure_before));
}

}  // namespace pcor
