#pragma once

#include <vector>

namespace pcor::internal {

/// The step in which a series is recorded: the one that all its values are whole multiples of apart, as whole
/// hPa or tenths. 0 where its values have none that matters, as those of binary sensors.
double resolution_of(const std::vector<double>& values);

}  // namespace pcor::internal
