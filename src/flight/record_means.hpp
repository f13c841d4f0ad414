#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <pcor/flight/flight.hpp>
#include "numerics/missing.hpp"

namespace pcor::internal {

/// Means of `count` groups of consecutive samples, without missing ones: NaN without a sample.
/// @param circle wrapping range of an angle, which has circular means: NaN for directions that cancel
void average(const std::vector<double>& samples, std::size_t count,
             const std::optional<std::array<double, 2>>& circle, double* out);

/// Means of a series over its records, before a conversion of its unit.
struct RecordMeans {
  std::vector<double> values{};
  double minimum = infinity;   ///< smallest sample
  double maximum = -infinity;  ///< largest sample
  RejectedCounts excluded{};

  /// Adds the next records.
  void add(const std::vector<double>& samples, std::size_t records,
           const std::optional<std::array<double, 2>>& circle, const RejectedCounts& rejected);

  /// Whether a conversion rejects no sample, so that it may be applied to the means.
  bool are_within(const UnitConversion& conversion) const {
    return minimum > maximum || !(std::isnan(conversion(minimum)) || std::isnan(conversion(maximum)));
  }
};

}  // namespace pcor::internal
