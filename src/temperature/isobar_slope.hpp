#pragma once

#include <Eigen/Dense>

#include <pcor/temperature/temperature.hpp>
#include "temperature/height_record.hpp"

namespace pcor::internal {

/// Estimates the slope of isobaric surfaces over a flight, to the east and north, 1, by one of the options ii
/// to iv of the memo: from the heights of isobaric surfaces followed by level legs, crossed by climbs and
/// descents at different positions, or crossed anywhere in the flight. Heights are reduced to a common
/// pressure with the measured temperature. The direction across a straight flight is assumed level.
Eigen::Vector2d estimate_isobar_slope(const HeightRecord& record, IsobarSlope option);

/// Subtracts the estimated height change along the track due to isobars that are not level. The remaining
/// fraction of the usual slope is in `slope_fraction`, for the likelihood. No change for `none` and `fitted`,
/// or, with a note, if directions are unknown.
void subtract_isobar_slope(HeightRecord& record, IsobarSlope option);

}  // namespace pcor::internal
