#pragma once

#include <pcor/residuals/statistics.hpp>

#include <cstddef>

namespace pcor::internal {

/// Sums of residuals, from which statistics follow; those of flights add up.
struct ResidualSums {
  std::size_t samples = 0;
  double sum = 0.0;
  double squares = 0.0;
  double noise_squares = 0.0;
  double sum_variance = 0.0;  ///< of `sum`, by the noise; NaN: not known

  /// Adds a sample, without what it adds to `sum_variance`.
  void add(double residual, double noise);
  void add(const ResidualSums& other);
  Statistics statistics() const;
};

}  // namespace pcor::internal
