#pragma once

#include <array>
#include <string_view>

#include <pcor/physics/moist_air.hpp>

namespace pcor {

/// Recovery factor of a thermometer in the airstream: the measured fraction of the dynamic heating.
///
///     a_r(M) = c0 + c1 L + c2 L^2 + c3 L^3,   L = log10 M
///
/// Result: 1. Domain: M > 0 if the law depends on the Mach number; M <= 0 gives NaN.
struct RecoveryFactor {
  std::array<double, 4> coefficients{};  ///< c0 .. c3, 1

  static constexpr double maximum = 1.2;  ///< largest possible c0

  /// True if all coefficients are finite and c0 is above zero, at most `maximum`.
  constexpr bool is_possible() const {
    for (const double coefficient : coefficients) {
      if (!is_finite(coefficient)) return false;
    }
    return coefficients[0] > 0.0 && coefficients[0] <= maximum;
  }

  /// True if the law does not depend on the Mach number.
  constexpr bool is_constant() const {
    return coefficients[1] == 0.0 && coefficients[2] == 0.0 && coefficients[3] == 0.0;
  }

  /// The recovery factor at Mach number `mach`.
  template <class S>
  S operator()(const S& mach) const {
    return is_constant() ? S(coefficients[0]) : at(decimal_logarithm(mach), S(mach));
  }

  /// Recovery factor for the square of the Mach number, which avoids the latency of a root.
  template <class S>
  S at_square(const S& square) const {
    using std::log;
    if (is_constant()) return S(coefficients[0]);
    return at(S(S(0.5 * decimal_logarithm_of_e) * log(square)), square);
  }

 private:
  // Missing unless `moving`, the Mach number or its square, is positive.
  template <class S>
  S at(const S& logarithm, const S& moving) const {
    const S factor = S(coefficients[0]) + logarithm * S(coefficients[1]) +
                     logarithm * logarithm * (S(coefficients[2]) + logarithm * S(coefficients[3]));
    return select(moving > S(0.0), factor, missing<S>());
  }
};

/// A published law of the recovery factor.
struct PublishedRecoveryFactor {
  std::string_view name;
  std::string_view sensor;
  std::string_view since;  ///< first use in processing, year or date; empty if not recorded
  RecoveryFactor law;
  std::string_view source;
};

/// The published laws, by the names that a model file may use.
inline constexpr std::array<PublishedRecoveryFactor, 8> published_recovery_factors{{
    {"rosemount-unheated-2014",
     "Rosemount 102, unheated",
     "2014-10-14",
     {{0.9959, 0.0283, 0.0374, 0.0762}},
     "Cooper, Recovery factor study, NCAR, October 2014"},
    {"harco-heated-2014",
     "HARCO 100990-1, heated, element A",
     "2014-10-14",
     {{0.988, 0.053, 0.090, 0.091}},
     "Cooper, Recovery factor study, NCAR, October 2014"},
    {"harco-heated-b-2014",
     "HARCO 100990-1, heated, element B",
     "2014-10-14",
     {{0.973, 0.053, 0.090, 0.091}},
     "Cooper, Recovery factor study, NCAR, October 2014: element A less 0.015"},
    {"harco-heated-2022",
     "HARCO 100990-1, heated",
     "2022",
     {{0.979, 0.041, 0.090, 0.091}},
     "NCAR nimbus since 2022"},
    {"rosemount-heated",
     "Rosemount 102, heated",
     "2014-10-14",
     {{0.958, 0.0, 0.0, 0.0}},
     "Cooper, Recovery factor study, NCAR, October 2014"},
    {"rosemount-boom-2004",
     "Rosemount 102E2AL, boom, radome and wing",
     "1992",
     {{0.95, 0.0, 0.0, 0.0}},
     "NCAR nimbus, RECFB and RECFW"},
    {"rosemount-fuselage-2004",
     "Rosemount 102E2AL, fuselage",
     "1992",
     {{0.985, 0.0, 0.0, 0.0}},
     "NCAR nimbus, RECFF"},
    {"rosemount-deiced-2004",
     "Rosemount 102E2AL, heated",
     "1992",
     {{0.98, 0.0, 0.0, 0.0}},
     "NCAR nimbus, RECFRH"},
}};

/// Ambient temperature, K, from the recovery temperature `recovery_temperature` (K) at Mach number `mach`:
///
///     T = T_r / (1 + a_r M^2 (gamma-1)/2)
///
/// Source: memo, "Tests using flight maneuvers"; NCAR processing algorithms eq. 4.20.
template <class S>
S ambient_temperature(const S& recovery_temperature, const S& mach, const S& recovery_factor,
                      const MoistAir<S>& air) {
  return recovery_temperature /
         (S(1.0) + recovery_factor * mach * mach * (air.heat_capacity_ratio - S(1.0)) * S(0.5));
}

/// Ambient temperature, K, from the recovery temperature `recovery_temperature` (K) in air of which
/// `dynamic_heating` is `heating`: T = T_r/(1 + a_r h).
template <class S>
S ambient_temperature_from_heating(const S& recovery_temperature, const S& heating,
                                   const S& recovery_factor) {
  return recovery_temperature / (S(1.0) + recovery_factor * heating);
}

/// The temperature that a thermometer of recovery factor `recovery_factor` shows in air of `temperature` (K)
/// at Mach number `mach`, K: the inverse of `ambient_temperature`.
template <class S>
S recovery_temperature(const S& temperature, const S& mach, const S& recovery_factor,
                       const MoistAir<S>& air) {
  return temperature * (S(1.0) + recovery_factor * mach * mach * (air.heat_capacity_ratio - S(1.0)) * S(0.5));
}

}  // namespace pcor
