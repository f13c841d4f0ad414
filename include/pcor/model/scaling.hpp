#pragma once

namespace pcor {

/// Dependence of an effect on the measured pressures in addition to its formula, whose value is multiplied by
///
///     (p_m / 700 hPa)^static_pressure (q_m / 70 hPa)^dynamic_pressure
///
/// At these two pressures, typical of a C-130 at 3 km and 120 m/s (Cooper 2012), a coefficient has the same
/// meaning and typical size as without a scaling. A published law assumes a dependence on p or on q; the true
/// dependence may differ: `{-1, 1}` replaces p by q.
struct Scaling {
  int static_pressure = 0;
  int dynamic_pressure = 0;

  constexpr bool is_none() const { return static_pressure == 0 && dynamic_pressure == 0; }
};

constexpr bool operator==(const Scaling& a, const Scaling& b) {
  return a.static_pressure == b.static_pressure && a.dynamic_pressure == b.dynamic_pressure;
}

/// Maximum absolute exponent of a scaling; larger ones are not physical for a port.
inline constexpr int max_power = 3;

namespace detail {

template <class S>
S whole_power(const S& base, int power) {
  S product(1.0);
  for (int i = 0; i < (power < 0 ? -power : power); ++i) product = product * base;
  return power < 0 ? S(S(1.0) / product) : product;
}

}  // namespace detail

/// Factor of the scaling at the measured static and dynamic pressure, hPa. Missing if a pressure with a
/// nonzero exponent is missing.
template <class S>
S factor(const Scaling& scaling, const S& static_pressure, const S& dynamic_pressure) {
  return detail::whole_power(S(static_pressure * S(1.0 / 700.0)), scaling.static_pressure) *
         detail::whole_power(S(dynamic_pressure * S(1.0 / 70.0)), scaling.dynamic_pressure);
}

}  // namespace pcor
