#pragma once

#include <pcor/physics/scalar.hpp>

namespace pcor {

/// The calibration of a radome's differential pressure ports as a flow angle:
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

  /// The flow angle, deg. NaN if the ratio is NaN.
  template <class S>
  S operator()(const S& ratio, const S& mach) const {
    return S(offset) + ratio * (S(slope) + S(slope_mach) * mach);
  }

  /// The flow angle, deg, of a calibration without Mach number.
  template <class S>
  S operator()(const S& ratio) const {
    return S(offset) + ratio * S(slope);
  }
};

}  // namespace pcor
