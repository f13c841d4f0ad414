#pragma once

#include <string>
#include <vector>

#include <pcor/numerics/noise.hpp>

namespace pcor::internal {

/// Segments of marked samples. @param max_gap number of unmarked samples that a segment may contain in a row
std::vector<Segment> marked_segments(const std::vector<bool>& marked, std::size_t max_gap = 0);

/// Text like "15:04:42-15:13:02, 15:20:10-15:21:00 UTC": the first and the last sample of each segment, at
/// most six segments, and the number of the others.
std::string times_of(const std::vector<Segment>& segments, const std::vector<double>& time);

}  // namespace pcor::internal
