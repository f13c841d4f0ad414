#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace pcor::internal {

/// Missing value in a series.
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Whether a series has a value anywhere.
inline bool has_value(const std::vector<double>& series) {
  return std::any_of(series.begin(), series.end(), [](double x) { return std::isfinite(x); });
}

/// Mean of the available values; NaN if there is no value.
inline double mean_of(const std::vector<double>& series) {
  double sum = 0.0;
  double count = 0.0;
  for (const double value : series) {
    if (!std::isfinite(value)) continue;
    sum += value;
    count += 1.0;
  }
  return sum / count;
}

inline constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace pcor::internal
