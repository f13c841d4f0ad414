#pragma once

#include <pcor/physics/constants.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor {

/// Saturation vapour pressure over (supercooled) liquid water, hPa, at `temperature` in K.
///
///     ln(e/Pa) = 54.842763 - 6763.22/T - 4.21 ln T + 0.000367 T
///                + tanh(0.0415 (T - 218.8)) (53.878 - 1331.22/T - 9.44523 ln T + 0.014025 T)
///
/// Domain: 123 to 332 K, accuracy 0.05 % as stated by the source; T <= 0 gives NaN.
/// Source: Murphy and Koop, Q. J. R. Meteorol. Soc. 131, 1539-1565 (2005), eq. 10.
template <class S>
S vapor_pressure_over_water(const S& temperature) {
  require_scalar<S>();
  using std::exp;
  using std::log;
  const S logarithm = log(temperature);
  const S inverse = S(1.0) / temperature;
  const S blend = hyperbolic_tangent(S(0.0415) * (temperature - S(218.8)));
  const S warm = S(54.842763) - S(6763.22) * inverse - S(4.210) * logarithm + S(0.000367) * temperature;
  const S cold = S(53.878) - S(1331.22) * inverse - S(9.44523) * logarithm + S(0.014025) * temperature;
  return S(0.01) * exp(warm + blend * cold);
}

/// Lower bound of the saturation vapour pressure over water, hPa, at `temperature` in K, at a fraction of the
/// cost of `vapor_pressure_over_water`:
///
///     e = (1.160299 + 1.622958 x + 0.6518156 x^2 + 0.002964515 x^3 - 0.02742532 x^4)^4 hPa,
///     x = (T - 257.5 K)/67.5 K
///
/// Between 0.9969 and 0.99993 of saturation from 190 to 325 K, to which it was fitted; zero elsewhere. NaN
/// gives NaN.
template <class S>
S vapor_pressure_below_saturation(const S& temperature) {
  require_scalar<S>();
  const S x = (temperature - S(257.5)) * S(1.0 / 67.5);
  const S square = x * x;
  const S root =
      S(1.160299) + S(1.622958) * x + square * (S(0.6518156) + S(0.002964515) * x - S(0.02742532) * square);
  const S root_square = root * root;
  return select(temperature < S(190.0) || temperature > S(325.0), S(0.0), S(root_square * root_square));
}

/// Saturation vapour pressure over ice, hPa, at `temperature` in K.
///
///     ln(e/Pa) = 9.550426 - 5723.265/T + 3.53068 ln T - 0.00728332 T
///
/// Domain: 110 K to 273.16 K, accuracy 0.025 % as stated by the source; zero at 0 K, T < 0 gives NaN.
/// Source: Murphy and Koop (2005), eq. 7.
template <class S>
S vapor_pressure_over_ice(const S& temperature) {
  require_scalar<S>();
  using std::exp;
  using std::log;
  return S(0.01) * exp(S(9.550426) - S(5723.265) / temperature + S(3.53068) * log(temperature) -
                       S(0.00728332) * temperature);
}

/// Saturation vapour pressure over a chilled mirror at `temperature` in K, hPa: over ice below the ice point,
/// otherwise over water. Domain and accuracy are those of the two laws. Source: Murphy and Koop (2005).
template <class S>
S saturation_vapor_pressure(const S& temperature) {
  require_scalar<S>();
  return select(temperature < S(constants::ice_point), vapor_pressure_over_ice(temperature),
                vapor_pressure_over_water(temperature));
}

/// Enhancement factor of the vapour pressure at `temperature` (K) in air at `pressure` (hPa), 1:
///
///     f = 1 + 1e-5 p (4.923 - 0.0325 T + 5.84e-5 T^2)
///
/// Source: Murphy and Koop (2005), appendix.
template <class S>
S enhancement_factor(const S& temperature, const S& pressure) {
  require_scalar<S>();
  return S(1.0) + S(1e-5) * pressure * (S(4.923) + temperature * (S(-0.0325) + S(5.84e-5) * temperature));
}

/// Vapour pressure, hPa, from the dew point (K) in air at `pressure` (hPa): over water at any temperature,
/// which is the convention of NCAR's DPXC. Accuracy of `vapor_pressure_over_water`; NaN gives NaN.
template <class S>
S vapor_pressure_from_dew_point(const S& dew_point, const S& pressure) {
  require_scalar<S>();
  return vapor_pressure_over_water(dew_point) * enhancement_factor(dew_point, pressure);
}

/// Vapour pressure, hPa, from the temperature of a chilled mirror (K) in air at `pressure` (hPa). Below the
/// ice point the mirror is assumed to carry ice: at -20 deg C the result is 18 % lower than for a dew point.
/// NaN gives NaN.
template <class S>
S vapor_pressure_from_frost_point(const S& frost_point, const S& pressure) {
  require_scalar<S>();
  return saturation_vapor_pressure(frost_point) * enhancement_factor(frost_point, pressure);
}

}  // namespace pcor
