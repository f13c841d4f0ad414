#pragma once

#include <functional>
#include <utility>
#include <vector>

#include <pcor/regimes/regimes.hpp>

namespace pcor::internal::manoeuvres {

/// A value in the course of a manoeuvre, at s since its begin. Defined beyond both ends too.
using Course = std::function<double(double)>;

Course constant(double value);

/// Straight lines through points (s, value), constant beyond the ends. At least one point, times increase.
Course through(std::vector<std::pair<double, double>> points);

/// An oscillation, amplitude times sin(2 pi t/period), that grows over the first and dies over the last
/// `ramp` s of its cycles.
Course oscillation(double amplitude, double period, double cycles, double ramp);

/// What moves steadily by `rate` a second from `begin` to `end` and is at rest before and after, zero at
/// first; the rate grows and dies over `ramp` s.
Course steady_change(double rate, double begin, double end, double ramp);

/// The way of an aircraft through the air, without wind.
struct Path {
  double duration = 0.0;                     ///< s
  Course height;                             ///< m
  Course airspeed;                           ///< true, m/s
  Course roll = constant(0.0);               ///< deg
  Course sideslip = constant(0.0);           ///< deg
  Course flaps = constant(0.0);              ///< percent
  Course liquid_water = constant(0.0);       ///< g/m3
  Course cabin_pressure{};                   ///< hPa; absent: as usual at the height
  std::pair<double, double> not_recorded{};  ///< from and to, s: between two parts of the manoeuvre
  std::vector<Interval> regimes{};           ///< times in s since the begin
};

}  // namespace pcor::internal::manoeuvres
