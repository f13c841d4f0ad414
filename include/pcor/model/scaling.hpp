#pragma once

namespace pcor {

/// How an effect goes with the measured pressures beyond its formula, whose value is multiplied by
///
///     (p_m / 700 hPa)^static_pressure (q_m / 70 hPa)^dynamic_pressure
///
/// At these two pressures, which a C-130 meets at 3 km and 120 m/s (Cooper 2012), a coefficient means what it
/// means without a scaling, and has its usual size. A law has to assume that a term goes with p or with q,
/// and nature may do otherwise: `{-1, 1}` puts q in the place of p.
struct Scaling {
  int static_pressure = 0;
  int dynamic_pressure = 0;

  constexpr bool is_none() const { return static_pressure == 0 && dynamic_pressure == 0; }
};

constexpr bool operator==(const Scaling& a, const Scaling& b) {
  return a.static_pressure == b.static_pressure && a.dynamic_pressure == b.dynamic_pressure;
}

/// The largest power of a scaling, up or down: steeper is nothing that a port does.
inline constexpr int max_power = 3;

namespace detail {

template <class S>
S whole_power(const S& base, int power) {
  S product(1.0);
  for (int i = 0; i < (power < 0 ? -power : power); ++i) product = product * base;
  return power < 0 ? S(S(1.0) / product) : product;
}

}  // namespace detail

/// By what the scaling multiplies, at the measured static and dynamic pressure, hPa. A missing pressure that
/// is asked for gives a missing factor.
template <class S>
S factor(const Scaling& scaling, const S& static_pressure, const S& dynamic_pressure) {
  return detail::whole_power(S(static_pressure * S(1.0 / 700.0)), scaling.static_pressure) *
         detail::whole_power(S(dynamic_pressure * S(1.0 / 70.0)), scaling.dynamic_pressure);
}

}  // namespace pcor
