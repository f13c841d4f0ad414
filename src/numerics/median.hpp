#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "numerics/missing.hpp"

namespace pcor::internal {

/// The standard deviation of a normal distribution over the median of its absolute values: 1 over its
/// quantile at 0.75.
inline constexpr double deviation_of_median = 1.482602218505602;

/// For an even count, returns the upper of the two middle values. NaN values are excluded; NaN if no values
/// remain.
inline double median(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double value) { return std::isnan(value); }),
               values.end());
  if (values.empty()) return nan;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace pcor::internal
