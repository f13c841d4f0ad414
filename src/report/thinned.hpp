#pragma once

#include <cstddef>
#include <vector>

namespace pcor::internal::report {

/// A series of a value per sample, and by how much its values count.
struct ScaledSeries {
  const std::vector<double>* values;
  double scale = 1.0;
};

/// The samples between which a straight line in time stands best for all the series, at most so many: first
/// the ends of each flight, then again and again the sample at which some series is furthest from its line.
/// Samples at which a series has no value are left out.
///
/// @param begins the first sample of each flight
/// @param most of the samples that are kept, beside two for each flight
/// @param enough a line that is as near as this to all series (scaled) is not divided
std::vector<std::size_t> thinned(const std::vector<double>& time, const std::vector<std::size_t>& begins,
                                 const std::vector<ScaledSeries>& series, std::size_t most, double enough);

}  // namespace pcor::internal::report
