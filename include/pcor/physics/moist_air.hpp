#pragma once

#include <type_traits>

#include <pcor/physics/constants.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor {

/// The thermodynamic constants of air with water vapour, at one humidity.
template <class S>
struct MoistAir {
  static_assert(!std::is_integral_v<S>, "pcor computes with floating-point numbers: write 0.0, not 0");

  S gas_constant;            ///< R_a, J/(kg K), eq. 14
  S specific_heat_volume;    ///< c_v, J/(kg K), eq. 15
  S specific_heat_pressure;  ///< c_p, J/(kg K), eq. 16
  S heat_capacity_ratio;     ///< gamma = c_p/c_v, 1, eq. 17
  S poisson_exponent;        ///< R_a/c_p, 1: the exponent of (p+q)/p in the temperature ratio
  S degrees_of_freedom;      ///< 2 c_v/R_a, 1: of a molecule, on average
};

/// Constants of air whose vapour pressure is the fraction `e_over_p` of its pressure.
///
///     R_a = R_d / (1 + (eps - 1) e/p)
///     c_v = c_vd (R_a/R_d) (1 + e/(5p)),   c_p = c_pd (R_a/R_d) (1 + e/(7p)),   gamma = c_p/c_v
///
/// Water vapour counts as a gas of six degrees of freedom, dry air as one of five, so that on average there
/// are 5 + e/p. Then c_p - c_v = R_a exactly.
/// Domain: 0 <= e/p < 1; NaN gives NaN. Accuracy: real dry air has c_p 0.1 % above 7/2 R_d, which changes
/// delta-p from LAMS by less than 0.07 hPa. Source: memo eq. 13-17.
template <class S>
constexpr MoistAir<S> moist_air(const S& e_over_p) {
  namespace c = constants;
  const S ratio = S(1.0) / (S(1.0) + S(c::molar_mass_ratio - 1.0) * e_over_p);
  const S volume = S(1.0) + S(1.0 / 5.0) * e_over_p;
  const S pressure = S(1.0) + S(1.0 / 7.0) * e_over_p;
  return {S(c::gas_constant_dry_air) * ratio,
          S(c::specific_heat_volume_dry_air) * ratio * volume,
          S(c::specific_heat_pressure_dry_air) * ratio * pressure,
          S(7.0 / 5.0) * pressure / volume,
          S(2.0 / 7.0) / pressure,
          S(5.0) + e_over_p};
}

/// Constants of dry air: gamma = 7/5, R/c_p = 2/7. No computation, for any scalar.
template <class S>
constexpr MoistAir<S> dry_air() {
  constexpr MoistAir<double> dry = moist_air(0.0);
  return {S(dry.gas_constant),        S(dry.specific_heat_volume), S(dry.specific_heat_pressure),
          S(dry.heat_capacity_ratio), S(dry.poisson_exponent),     S(dry.degrees_of_freedom)};
}

}  // namespace pcor
