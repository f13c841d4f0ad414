#pragma once

#include <vector>

#include "numerics/least_squares.hpp"

namespace pcor::internal {

/// What one circle says.
struct CircleFit {
  Estimated east_wind{};        ///< m/s, from the west positive
  Estimated north_wind{};       ///< m/s, from the south positive
  Estimated airspeed_error{};   ///< of the true airspeed, too high positive, m/s
  Estimated heading_error{};    ///< of the heading, clockwise positive, less the sideslip, deg
  double rms = 0.0;             ///< of the ground velocity that is left, m/s
  double turned = 0.0;          ///< deg, to starboard positive
  std::vector<double> along{};  ///< what is left of the ground velocity along the heading, m/s
};

/// Fits a turn: the ground velocity is the wind and the airspeed along the heading,
///
///     v_east  = W_east  + (v - d) sin h - v e cos h
///     v_north = W_north + (v - d) cos h + v e sin h
///
/// with the error d of the airspeed v and the error e of the heading h, rad, which in a turn also stands for
/// the sideslip and for the angle of attack times the bank. Least squares over both components; the columns
/// are independent where the heading goes most of the way round. Series in m/s, heading in deg; NaN is left
/// out. NaN where the fit is not possible.
CircleFit fit_circle(const std::vector<double>& airspeed, const std::vector<double>& heading,
                     const std::vector<double>& east_speed, const std::vector<double>& north_speed,
                     const std::vector<double>& time, double step);

}  // namespace pcor::internal
