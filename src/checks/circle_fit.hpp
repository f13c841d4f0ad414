#pragma once

#include <vector>

#include "numerics/least_squares.hpp"

namespace pcor::internal {

/// Result of one circle.
struct CircleFit {
  Estimate east_wind{};         ///< m/s, westerly positive
  Estimate north_wind{};        ///< m/s, southerly positive
  Estimate airspeed_error{};    ///< error of the true airspeed, too high positive, m/s
  Estimate heading_error{};     ///< error of the heading, clockwise positive, minus the sideslip, deg
  double rms = 0.0;             ///< rms residual of the ground velocity, m/s
  double turned = 0.0;          ///< heading change, deg, to starboard positive
  std::vector<double> along{};  ///< residual of the ground velocity along the heading, m/s
};

/// Fits a turn: the ground velocity is the wind and the airspeed along the heading,
///
///     v_east  = W_east  + (v - d) sin h - v e cos h
///     v_north = W_north + (v - d) cos h + v e sin h
///
/// with the error d of the airspeed v and the error e of the heading h, rad, which in a turn also includes
/// the sideslip and the angle of attack times the bank. Least squares over both components; the columns are
/// independent if the heading covers most of a circle. Series in m/s, heading in deg; NaN values are
/// excluded. NaN if the fit is not possible.
CircleFit fit_circle(const std::vector<double>& airspeed, const std::vector<double>& heading,
                     const std::vector<double>& east_speed, const std::vector<double>& north_speed,
                     const std::vector<double>& time, double step);

}  // namespace pcor::internal
