#pragma once

#include <string>
#include <vector>

#include <pcor/base/note.hpp>
#include <pcor/model/quantity.hpp>

namespace pcor::internal {

/// Resolution of a recorded series: all differences of its values are multiples of this step, for example
/// whole hPa or tenths. 0 if no step matters, for example for binary sensors.
double resolution_of(const std::vector<double>& values);

/// Minimum step at which rounding contributes noticeably to the noise of a pressure, hPa.
inline constexpr double coarse_pressure = 0.0999;

/// Rms error of rounding to a step.
double rounding_of(double step);

/// Notes the rounding of a recorded pressure, hPa, whose resolution is a considerable part of its noise.
void note_coarse(Quantity quantity, const std::string& variable, const std::vector<double>& values,
                 Notes& notes);

}  // namespace pcor::internal
