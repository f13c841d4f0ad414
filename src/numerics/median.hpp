#pragma once

#include <vector>

namespace pcor::internal {

/// The standard deviation of a normal distribution over the median of its absolute values: 1 over its
/// quantile at 0.75.
inline constexpr double deviation_of_median = 1.482602218505602;

/// For an even count, returns the upper of the two middle values. NaN values are excluded; NaN if no values
/// remain.
double median(std::vector<double> values);

}  // namespace pcor::internal
