#pragma once

#include <pcor/temperature/temperature.hpp>
#include "temperature/height_record.hpp"

namespace pcor::internal {

/// Slope of isobaric surfaces over a flight, with its source.
struct IsobarSlopeEstimate {
  double east = 0.0;       ///< rise per distance, 1
  double north = 0.0;      ///< 1
  std::size_t blocks = 0;  ///< number of blocks used; 0: no estimate
};

/// Estimates the slope by one of the options ii to iv of the memo: from the heights of isobaric surfaces
/// followed by level legs, crossed by climbs and descents at different positions, or crossed anywhere in the
/// flight. Heights are reduced to a common pressure with the measured temperature. The direction across a
/// straight flight is assumed level.
IsobarSlopeEstimate estimate_isobar_slope(const HeightRecord& record, IsobarSlope option);

/// Subtracts the height change along the track due to isobars that are not level: from an estimate, or from
/// the geostrophic wind at every position. The remaining fraction of the usual slope is in `slope_left`, for
/// the likelihood. No change for `none` and `fitted`, or if the required variables are not recorded, with a
/// note.
void take_off_isobar_slope(HeightRecord& record, IsobarSlope option);

}  // namespace pcor::internal
