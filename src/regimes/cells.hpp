#pragma once

#include <cstddef>
#include <vector>

#include <pcor/regimes/regimes.hpp>

namespace pcor::internal {

/// Motion of a flight as means over cells of one second, for any sampling rate. Every series has one value
/// for each cell, NaN if missing; gaps up to 5 s are interpolated. A gap in the time is kept as cells without
/// values, up to 300 of them, so that memory does not grow with gaps.
struct Cells {
  std::vector<double> begin;  ///< start time of each cell, s since 1970 UTC, followed by the end time of the
                              ///< last one
  std::vector<double> airspeed;
  std::vector<double> altitude;
  std::vector<double> vertical_speed;  ///< recorded, otherwise from the altitude
  std::vector<double> roll;            ///< recorded, otherwise the roll of a coordinated turn with this
                                       ///< heading rate
  std::vector<double> pitch;
  std::vector<double> heading;  ///< deg, not wrapped: it continues beyond 360
  std::vector<double> sideslip;
  std::vector<double> liquid_water;

  std::size_t count() const { return airspeed.size(); }
};

/// @throws Error as does `find_regimes`
Cells cells_of(const FlightMotion& motion);

}  // namespace pcor::internal
