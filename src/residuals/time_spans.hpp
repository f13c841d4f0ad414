#pragma once

#include <string>
#include <vector>

#include "regimes/series.hpp"

namespace pcor::internal {

/// Runs of marked samples. @param max_gap number of unmarked samples that a run may contain in a row
std::vector<IndexRange> marked_runs(const std::vector<bool>& marked, std::size_t max_gap = 0);

/// Text like "15:04:42-15:13:02, 15:20:10-15:21:00 UTC": the first and the last sample of each run, at most
/// six runs, and the number of the others.
std::string times_of(const std::vector<IndexRange>& runs, const std::vector<double>& time);

}  // namespace pcor::internal
