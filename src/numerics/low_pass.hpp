#pragma once

#include <vector>

namespace pcor::internal {

/// Gaussian low-pass filter over the available values; a missing value (NaN) stays missing.
/// @param deviation of the Gaussian, in samples, above 0
std::vector<double> low_passed(const std::vector<double>& values, double deviation);

}  // namespace pcor::internal
