#pragma once

#include <vector>

namespace pcor::internal {

/// The standard deviation of a normal distribution over the median of its absolute values: 1 over its
/// quantile at 0.75.
inline constexpr double deviation_of_median = 1.482602218505602;

/// Of an even number of values the upper of the middle two. NaN are left out; NaN where nothing is left.
double median(std::vector<double> values);

}  // namespace pcor::internal
