#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "numerics/missing.hpp"

namespace pcor::internal {

/// Arithmetic on series with one value each second, NaN where there is none.

/// The cells from `first` up to but not including `end`.
struct Run {
  std::size_t first = 0;
  std::size_t end = 0;

  std::size_t length() const { return end - first; }
};

/// At each cell the mean of the known values at most `window` / 2 cells away; NaN where there are none.
std::vector<double> running_mean(const std::vector<double>& values, std::size_t window);

/// The running mean of the running mean: a triangular window, which passes next to nothing of oscillations
/// shorter than `window`.
std::vector<double> smoothed_twice(const std::vector<double>& values, std::size_t window);

/// The mean of the known values of a run; NaN if there are none.
double mean(const std::vector<double>& values, Run run);

/// The least and the greatest of the known values of a run; NaN if there are none.
struct Extent {
  double least;
  double greatest;

  double range() const { return greatest - least; }
};
Extent extent(const std::vector<double>& values, Run run);

/// The cell at which a step fits a run best: the first after it, if both sides are taken as constant (least
/// squares), with at least `shortest` known values on each side. `otherwise` if there are too few.
std::size_t best_step(const std::vector<double>& values, Run run, std::size_t shortest,
                      std::size_t otherwise);

/// The longest runs of cells below `count` of which the predicate is true.
template <class Predicate>
std::vector<Run> runs_where(std::size_t count, Predicate predicate) {
  std::vector<Run> runs;
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

/// Runs that are at most `gap` cells apart as one.
std::vector<Run> bridged(const std::vector<Run>& runs, std::size_t gap);

/// The runs of at least `length` cells.
std::vector<Run> not_shorter(std::vector<Run> runs, std::size_t length);

}  // namespace pcor::internal
