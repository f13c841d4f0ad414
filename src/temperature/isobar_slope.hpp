#pragma once

#include <pcor/temperature/temperature.hpp>
#include "temperature/height_record.hpp"

namespace pcor::internal {

/// The slope of isobaric surfaces over a flight, and how it was found.
struct IsobarSlopeEstimate {
  double east = 0.0;       ///< rise per distance, 1
  double north = 0.0;      ///< 1
  std::size_t blocks = 0;  ///< that tell of it; 0: the flight does not
};

/// Estimates the slope by one of the options ii to iv of the memo: from the heights of isobaric surfaces that
/// level legs follow, that climbs and descents cross at different places, or that the whole flight meets.
/// Heights are brought to a common pressure with the measured temperature. What a flight along one line
/// cannot tell is taken for level.
IsobarSlopeEstimate estimate_isobar_slope(const HeightRecord& record, IsobarSlope option);

/// Takes from the heights of a flight what they rise along the way because isobars are not level: by an
/// estimate, or by the geostrophic wind at every place. No estimate is without error: `slope_left` says what
/// part of a usual slope it leaves for the likelihood. Takes nothing for `none` and `fitted`, and where the
/// flight does not record what it takes, of which it adds a note.
void take_off_isobar_slope(HeightRecord& record, IsobarSlope option);

}  // namespace pcor::internal
