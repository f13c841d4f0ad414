#pragma once

#include <pcor/numerics/noise.hpp>
#include <pcor/residuals/residuals.hpp>
#include <pcor/residuals/statistics.hpp>

#include <vector>

#include "residuals/residual_sums.hpp"

namespace pcor::internal {

// The one definition of rms, bias and noise of a residual: compare, refit, diagnose and improve print these.
// The residual is that of `Residuals::values`, exact, one value for each record; every sample that takes part
// counts once, outliers too.

/// Values at some of the samples, NaN at all others.
std::vector<double> only_at(const std::vector<double>& values, const std::vector<std::size_t>& samples);

/// Values at the samples with one mask, NaN at all others.
std::vector<double> masked(const std::vector<double>& values, const std::vector<Mask>& masks, Mask mask);

/// The noise floor of a flight. @param residual NaN where a sample takes no part
NoiseFloor noise_of_flight(const FlightSamples& samples, const std::vector<double>& residual);

/// The sums of a residual that is NaN where it does not count. @param noise of the flight, which may be that
/// of more samples
ResidualSums sums_of_flight(const FlightSamples& samples, const std::vector<double>& residual,
                            const NoiseFloor& noise);

/// As above, with the noise of these samples alone.
ResidualSums sums_of_flight(const FlightSamples& samples, const std::vector<double>& residual);

/// The sums over the samples that are left out for nothing but their flaps.
ResidualSums flaps_out(const Residuals& residuals, const double* parameters);

/// By how much squared residuals fall, in units of the noise, and its error from how that differs between
/// minutes, or longer stretches that are independent.
struct Gain {
  double value = 0.0;
  double error = 0.0;
};

/// From residuals `before` to residuals `after`, both of all samples; NaN where they do not count.
/// @param window over which a residual holds together, s: the samples within count as one; 0 for one sample
Gain gain_between(const FlightSamples& samples, const std::vector<double>& before,
                  const std::vector<double>& after, const NoiseFloor& noise, double window = 0.0);

/// The means of a residual over every five minutes, of which at least half count.
std::vector<double> means_of_blocks(const FlightSamples& samples, const std::vector<double>& residual);

/// By how much the means of residuals differ from zero where they were fitted: of blocks, and of flights.
class FittedMeans {
 public:
  /// Adds a flight. @param blocks their means, hPa
  void add(const std::vector<double>& blocks);

  /// The standard error of the mean of a residual that is held out, were the model as right there as where it
  /// was fitted, hPa. 0 where the means say nothing.
  /// @param held_out how many blocks are
  double expected_bias(std::size_t held_out) const;

 private:
  double blocks_ = 0.0;
  double block_squares_ = 0.0;
  double flights_ = 0.0;
  double flight_squares_ = 0.0;
};

}  // namespace pcor::internal
