#pragma once

#include <vector>

namespace pcor::internal {

/// The step in which a series is recorded: the one that all its values are whole multiples of apart, as whole
/// hPa or tenths. 0 where its values have none that matters, as those of binary sensors.
double resolution_of(const std::vector<double>& values);

/// From this step on rounding is no small part of the noise of a pressure, hPa.
inline constexpr double coarse_pressure = 0.0999;

/// The rms of what rounding to a step takes away.
double rounding_of(double step);

}  // namespace pcor::internal
