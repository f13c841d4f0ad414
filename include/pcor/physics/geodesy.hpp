#pragma once

#include <pcor/physics/constants.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor {

namespace constants {

/// Semi-major axis of the ellipsoid, m. WGS 84, NIMA TR8350.2.
inline constexpr double ellipsoid_semi_major_axis = 6378137.0;

/// Flattening of the ellipsoid, 1. WGS 84.
inline constexpr double ellipsoid_flattening = 1.0 / 298.257223563;

/// First eccentricity of the ellipsoid, squared, 1. WGS 84.
inline constexpr double ellipsoid_eccentricity_squared = 6.69437999014e-3;

/// Centrifugal over gravitational acceleration at the equator, m = omega^2 a^2 b/(GM), 1. WGS 84.
inline constexpr double ellipsoid_rotation = 3.449786506841e-3;

}  // namespace constants

/// Normal gravity on the ellipsoid, m/s2, at `latitude` in degrees:
///
///     gamma = 9.7803253359 (1 + k sin^2) / (1 - e^2 sin^2)^(1/2),   k = 0.00193185265241
///
/// Domain: -90 to 90 degrees; NaN gives NaN. Accuracy: real gravity differs from the normal field by about
/// 3e-4 m/s2, over high mountains and ocean trenches by ten times this value. Source: Somigliana's formula,
/// WGS 84, NIMA TR8350.2 eq. 4-1.
template <class S>
S normal_gravity(const S& latitude) {
  require_scalar<S>();
  using std::sin;
  using std::sqrt;
  const S sine = sin(S(latitude * S(constants::radians_per_degree)));
  const S square = sine * sine;
  return S(9.7803253359) * (S(1.0) + S(0.00193185265241) * square) /
         sqrt(S(S(1.0) - S(constants::ellipsoid_eccentricity_squared) * square));
}

/// (1 + f + m - 2 f sin^2)/a, 1/m: how fast gravity falls with height, half the relative rate at the ground.
template <class S>
S gravity_decrease(const S& latitude) {
  require_scalar<S>();
  using std::sin;
  const S sine = sin(S(latitude * S(constants::radians_per_degree)));
  const S square = sine * sine;
  return (S(1.0 + constants::ellipsoid_flattening + constants::ellipsoid_rotation) -
          S(2.0 * constants::ellipsoid_flattening) * square) *
         S(1.0 / constants::ellipsoid_semi_major_axis);
}

/// Geopotential height, m, of the geometric `height` (m above the ellipsoid; above the sea level does as
/// well, 100 m are 3e-5 of gravity) at `latitude` (degrees): the integral over height of
///
///     g = gamma [1 - 2 (1 + f + m - 2 f sin^2) h/a + 3 h^2/a^2],
///
/// divided by standard gravity. Lower than the geometric one by 4 m at 5 km and 45 degrees, and by 55 m at
/// 12 km on the equator. Domain: -1 to 30 km; NaN gives NaN. Accuracy: 2 mm up to 20 km, 7 mm up to 30 km.
/// Source: WMO-No. 8, part I, chapter 12; g: NIMA TR8350.2 eq. 4-3.
template <class S>
S geopotential_height(const S& latitude, const S& height) {
  require_scalar<S>();
  const S across = height * S(1.0 / constants::ellipsoid_semi_major_axis);
  return normal_gravity(latitude) * S(1.0 / constants::standard_gravity) * height *
         (S(1.0) - gravity_decrease(latitude) * height + across * across);
}

}  // namespace pcor
