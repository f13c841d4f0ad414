#pragma once

#include <pcor/physics/scalar.hpp>

namespace pcor {

/// Calibration of the differential pressure ports of a radome, which gives a flow angle:
///
///     angle = offset + ratio (slope + slope_mach M)     [deg]
///
/// where `ratio` is the differential over the dynamic pressure: ADIFR/QCR for the angle of attack, BDIFR/QCR
/// for the sideslip. Source: NCAR processing algorithms sec. 4.5.
struct RadomeCalibration {
  double offset = 0.0;      ///< deg
  double slope = 0.0;       ///< deg for a unit of the pressure ratio
  double slope_mach = 0.0;  ///< deg for a unit of the pressure ratio times the Mach number

  constexpr bool is_calibrated() const { return slope != 0.0 || slope_mach != 0.0; }
  constexpr bool needs_mach() const { return slope_mach != 0.0; }

  /// Flow angle, deg. NaN if the ratio or the Mach number is NaN, also with a zero `slope_mach`.
  template <class S>
  S operator()(const S& ratio, const S& mach) const {
    require_scalar<S>();
    return S(offset) + ratio * (S(slope) + S(slope_mach) * mach);
  }

  /// Flow angle, deg, without the term of the Mach number. NaN if the ratio is NaN.
  template <class S>
  S operator()(const S& ratio) const {
    require_scalar<S>();
    return S(offset) + ratio * S(slope);
  }
};

}  // namespace pcor
