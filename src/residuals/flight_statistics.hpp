#pragma once

#include <Eigen/Dense>
#include <pcor/numerics/noise.hpp>
#include <pcor/residuals/residuals.hpp>
#include <pcor/residuals/statistics.hpp>

#include <cstddef>
#include <vector>

#include "numerics/least_squares.hpp"

namespace pcor::internal {

// Definition of rms, bias and noise of a residual for compare, refit, diagnose and improve. The residual is
// `Residuals::values`, exact, one value for each record; every used sample counts once, including outliers.

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
  /// @param level_is_determined false: the bias is the mean residual
  Statistics statistics(bool level_is_determined = true) const;
  /// False if these are sums by GPS and the standard error of their bias is not below 1 hPa.
  bool determines_level() const;
};

/// Values at some of the samples, NaN at all others.
std::vector<double> select_samples(const std::vector<double>& values,
                                   const std::vector<std::size_t>& samples);

/// Values at the samples with one mask, NaN at all others.
std::vector<double> masked(const std::vector<double>& values, const std::vector<Mask>& masks, Mask mask);

/// Noise floor of a flight. @param residual NaN if a sample is excluded
NoiseFloor noise_of_flight(const FlightSamples& samples, const std::vector<double>& residual);

/// Sums of a residual, NaN where excluded, without the variance of their sum. @param noise of the flight,
/// possibly from more samples
ResidualSums sums_of_samples(const std::vector<double>& residual, const NoiseFloor& noise);

/// Sums of a residual and the variance of their sum.
ResidualSums sums_of_flight(const FlightSamples& samples, const std::vector<double>& residual,
                            const NoiseFloor& noise);

/// Sums of a residual with the noise of these samples alone.
ResidualSums sums_of_flight(const FlightSamples& samples, const std::vector<double>& residual);

/// Sums over the samples that are excluded only because of their flaps.
ResidualSums flaps_out(const Residuals& residuals, const double* parameters);

/// Decrease of squared residuals, in units of the noise, from `before` to `after`, both of all samples; NaN
/// where excluded. Zero without samples; a single minute is never significant.
///
/// The standard error includes the memory of the noise, from the variation between minutes, or longer
/// stretches. It is increased for its few degrees of freedom: a change without a gain exceeds 1.645 errors
/// once in 20.
/// @param window of a residual, s: the samples within count as one; 0 for one sample
Estimate gain_between(const FlightSamples& samples, const std::vector<double>& before,
                      const std::vector<double>& after, const NoiseFloor& noise, double window = 0.0);

/// Means of a residual over blocks of five minutes with values for at least half of the samples.
std::vector<double> means_of_blocks(const FlightSamples& samples, const std::vector<double>& residual);

/// Deviation of the means of fitted residuals from zero: of blocks, and of flights.
class FittedMeans {
 public:
  /// Adds a flight. @param blocks means of its blocks, hPa
  void add(const std::vector<double>& blocks);

  /// Standard error of the mean of a held-out residual if the model were equally accurate on the held-out
  /// part, hPa. 0 if undetermined.
  /// @param held_out number of held-out blocks
  double expected_bias(std::size_t held_out) const;

 private:
  double blocks_ = 0.0;
  double block_squares_ = 0.0;
  double flights_ = 0.0;
  double flight_squares_ = 0.0;
};

}  // namespace pcor::internal
