#pragma once

#include <cstddef>
#include <vector>

#include <pcor/regimes/regimes.hpp>

namespace pcor::internal {

/// A flight's motion as means over cells of one second, whatever the rate of its samples. Every series has
/// one value for each cell, NaN where there is none; up to 5 s without a value are interpolated. A gap in the
/// time is kept as cells without values, up to 300 of them, so that memory does not grow with gaps.
struct Cells {
  std::vector<double> begin;  ///< s since 1970 UTC: of each cell, and at last the end of the last one
  std::vector<double> airspeed;
  std::vector<double> altitude;
  std::vector<double> vertical_speed;  ///< recorded, else from the altitude
  std::vector<double> roll;            ///< recorded, else that of a coordinated turn with this heading rate
  std::vector<double> pitch;
  std::vector<double> heading;  ///< deg, not wrapped: it goes on beyond 360
  std::vector<double> sideslip;
  std::vector<double> liquid_water;

  std::size_t count() const { return airspeed.size(); }
};

/// @throws Error as `find_regimes`
Cells cells_of(const FlightMotion& motion);

}  // namespace pcor::internal
