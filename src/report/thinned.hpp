#pragma once

#include <cstddef>
#include <vector>

namespace pcor::internal::report {

/// Series with a value per sample, and the scale of its values.
struct ScaledSeries {
  const std::vector<double>* values;
  double scale = 1.0;
};

/// Selects samples for which piecewise linear interpolation in time approximates all the series best, up to a
/// limit: first the ends of each flight, then repeatedly the sample with the largest deviation of any series
/// from its line. Samples at which a series has no value are excluded.
///
/// @param begins the first sample of each flight
/// @param maximum number of kept samples, in addition to two for each flight
/// @param enough lines with smaller (scaled) deviations of all series are not divided
std::vector<std::size_t> thinned(const std::vector<double>& time, const std::vector<std::size_t>& begins,
                                 const std::vector<ScaledSeries>& series, std::size_t maximum, double enough);

}  // namespace pcor::internal::report
