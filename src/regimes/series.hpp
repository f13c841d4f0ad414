#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "numerics/missing.hpp"

namespace pcor::internal {

/// Arithmetic on series with equal steps, such as one value each second; missing values are NaN.

/// Cells, or samples, from `first` up to but not including `end`.
struct IndexRange {
  std::size_t first = 0;
  std::size_t end = 0;

  std::size_t length() const { return end - first; }
};

/// Mean of the known values at most `window` / 2 cells from each cell; NaN if all are missing.
std::vector<double> running_mean(const std::vector<double>& values, std::size_t window);

/// Running mean of the running mean: a triangular window, which suppresses oscillations shorter than
/// `window`.
std::vector<double> smoothed_twice(const std::vector<double>& values, std::size_t window);

/// Angles that continue beyond a full turn instead of wrapping, deg.
std::vector<double> unwrapped(std::vector<double> angles);

/// Mean of the known values of a run; NaN if all are missing.
double mean(const std::vector<double>& values, IndexRange run);

/// Minimum and maximum of the known values of a run; NaN if all are missing.
struct Extent {
  double minimum;
  double maximum;

  double range() const { return maximum - minimum; }
};
Extent extent(const std::vector<double>& values, IndexRange run);

/// First cell after the best-fitting step in a run, if both sides are constant (least squares), with at least
/// `shortest` known values on each side. `otherwise` if there are too few.
std::size_t best_step(const std::vector<double>& values, IndexRange run, std::size_t shortest,
                      std::size_t otherwise);

/// Longest runs of cells below `count` that meet the predicate.
template <class Predicate>
std::vector<IndexRange> runs_where(std::size_t count, Predicate predicate) {
  std::vector<IndexRange> runs;
  for (std::size_t i = 0; i < count; ++i) {
    if (!predicate(i)) continue;
    if (!runs.empty() && runs.back().end == i) {
      runs.back().end = i + 1;
    } else {
      runs.push_back({i, i + 1});
    }
  }
  return runs;
}

/// Merges runs that are at most `gap` cells apart, if `may_join` holds for the merged run.
std::vector<IndexRange> merge_gaps(
    const std::vector<IndexRange>& runs, std::size_t gap,
    const std::function<bool(IndexRange)>& may_join = [](IndexRange) { return true; });

/// Runs of at least `length` cells.
std::vector<IndexRange> drop_short(std::vector<IndexRange> runs, std::size_t length);

}  // namespace pcor::internal
