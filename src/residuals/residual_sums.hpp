#pragma once

#include <Eigen/Dense>
#include <pcor/residuals/statistics.hpp>

#include <cstddef>

namespace pcor::internal {

/// Sums of residuals that determine their statistics; sums of flights are additive.
struct ResidualSums {
  std::size_t samples = 0;
  double sum = 0.0;
  double squares = 0.0;
  double noise_squares = 0.0;
  double sum_variance = 0.0;  ///< variance of `sum` due to the noise; NaN: unknown
  /// Against wind or height, if the atmosphere is separated: products of `gps_products_of_parts`. The mean
  /// residual then follows from these.
  Eigen::MatrixXd by_gps{};

  /// Adds a sample, without its contribution to `sum_variance`.
  void add(double residual, double noise);
  void add(const ResidualSums& other);
  Statistics statistics() const;
};

}  // namespace pcor::internal
