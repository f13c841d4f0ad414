#include "residuals/flight_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "numerics/binned_residual.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr double block_length = 300.0;  // s

/// Factor on a variance that is known to some degrees of freedom: 1.645 standard errors are then exceeded by
/// chance once in 20, as with a known variance (Wallace 1959, Annals of Mathematical Statistics 30, 1121).
double few_values_factor(double degrees_of_freedom) {
  constexpr double square = 1.645 * 1.645;
  const double correction = (8.0 * degrees_of_freedom + 3.0) / (8.0 * degrees_of_freedom + 1.0);
  return degrees_of_freedom / square * std::expm1(square * correction * correction / degrees_of_freedom);
}

/// Power of a series in each of its cosines, from half a period in the series to almost two values per
/// period. The mean of the series has no part in it.
std::vector<double> powers_of(const std::vector<double>& values) {
  constexpr double pi = 3.14159265358979323846;
  const auto count = static_cast<double>(values.size());
  std::vector<double> powers;
  for (std::size_t j = 1; j < values.size(); ++j) {
    const double step = pi * static_cast<double>(j) / count;
    double sum = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k)
      sum += values[k] * std::cos(step * (static_cast<double>(k) + 0.5));
    powers.push_back(2.0 / count * sum * sum);
  }
  return powers;
}

/// Variance of the sum of two or more values in equal steps of time, with any memory shorter than the series:
/// from the power in the slowest cosines (Lazarus et al. 2018, Journal of Business & Economic Statistics 36,
/// 541), a band that is halved as long as its slower half has more power than chance explains. Increased for
/// the number of these cosines.
double variance_of_sum(const std::vector<double>& values) {
  constexpr std::size_t min_band = 6;
  const std::vector<double> powers = powers_of(values);
  const auto mean = [&powers](std::size_t first, std::size_t end) {
    return std::accumulate(powers.data() + first, powers.data() + end, 0.0) /
           static_cast<double>(end - first);
  };
  std::size_t band = powers.size();
  // The halves of a white band of n cosines have a ratio of 1 +- sqrt(8/n).
  while (band >= min_band &&
         mean(0, band / 2) > (1.0 + 3.0 / std::sqrt(static_cast<double>(band))) * mean(band / 2, band))
    band /= 2;
  return static_cast<double>(values.size()) * mean(0, band) * few_values_factor(static_cast<double>(band));
}

}  // namespace

std::vector<double> select_samples(const std::vector<double>& values,
                                   const std::vector<std::size_t>& samples) {
  std::vector<double> result(values.size(), nan);
  for (const std::size_t i : samples) result[i] = values[i];
  return result;
}

std::vector<double> masked(const std::vector<double>& values, const std::vector<Mask>& masks, Mask mask) {
  std::vector<double> result = values;
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (masks[i] != mask) result[i] = nan;
  }
  return result;
}

NoiseFloor noise_of_flight(const FlightSamples& samples, const std::vector<double>& residual) {
  return noise_floor(residual, samples.time, samples.step);
}

ResidualSums sums_of_samples(const std::vector<double>& residual, const NoiseFloor& noise) {
  ResidualSums sums;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (!std::isnan(residual[i])) sums.add(residual[i], noise.local_rms[i]);
  }
  sums.sum_variance = nan;
  return sums;
}

ResidualSums sums_of_flight(const FlightSamples& samples, const std::vector<double>& residual,
                            const NoiseFloor& noise) {
  ResidualSums sums = sums_of_samples(residual, noise);
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (!std::isnan(residual[i])) used.push_back(i);
  }
  constexpr double max_bins = 1000.0;  // the noise of 67 minutes is found in bins of the usual 4 s
  const BinnedResidual binned(residual, samples.time, samples.step, max_bins);
  sums.sum_variance = binned.variance_of_sum(used, binned.noise_about_mean());
  return sums;
}

ResidualSums sums_of_flight(const FlightSamples& samples, const std::vector<double>& residual) {
  return sums_of_flight(samples, residual, noise_of_flight(samples, residual));
}

ResidualSums flaps_out(const Residuals& residuals, const double* parameters) {
  const std::vector<Mask>& masks = residuals.mask();
  if (std::find(masks.begin(), masks.end(), Mask::flaps) == masks.end()) return {};
  return sums_of_flight(residuals.samples(), masked(residuals.values(parameters), masks, Mask::flaps));
}

Estimate gain_between(const FlightSamples& samples, const std::vector<double>& before,
                      const std::vector<double>& after, const NoiseFloor& noise, double window) {
  const double segment = std::max(60.0, 2.0 * window);  // s
  const double weight = window > samples.step ? samples.step / window : 1.0;
  std::vector<double> gains;
  std::vector<double> changes;  // squares of the change of the residual
  for (std::size_t i = 0; i < after.size();) {
    const double end = samples.time[i] + segment;
    double gain = 0.0;
    double change = 0.0;
    bool is_used = false;
    for (; i < after.size() && samples.time[i] < end; ++i) {
      const double deviation = noise.local_rms[i];
      if (std::isnan(after[i]) || std::isnan(before[i]) || !(deviation > 0.0)) continue;
      const double unit = deviation * deviation / weight;
      gain += (before[i] * before[i] - after[i] * after[i]) / unit;
      change += std::pow(before[i] - after[i], 2) / unit;
      is_used = true;
    }
    if (!is_used) continue;
    gains.push_back(gain);
    changes.push_back(change);
  }
  const double sum = std::accumulate(gains.begin(), gains.end(), 0.0);
  if (gains.size() < 2) return {sum, std::abs(sum) * std::sqrt(few_values_factor(1.0))};
  // a^2 - b^2 = 2 b (a - b) + (a - b)^2: only the product with the residual b of the better model is noise.
  for (std::size_t k = 0; k < gains.size(); ++k) gains[k] -= std::copysign(changes[k], sum);
  return {sum, std::sqrt(variance_of_sum(gains))};
}

std::vector<double> means_of_blocks(const FlightSamples& samples, const std::vector<double>& residual) {
  std::vector<double> means;
  const double enough = 0.5 * block_length / samples.step;
  for (std::size_t i = 0; i < residual.size();) {
    const double end = samples.time[i] + block_length;
    double sum = 0.0;
    double count = 0.0;
    for (; i < residual.size() && samples.time[i] < end; ++i) {
      if (std::isnan(residual[i])) continue;
      sum += residual[i];
      count += 1.0;
    }
    if (count >= enough) means.push_back(sum / count);
  }
  return means;
}

void FittedMeans::add(const std::vector<double>& blocks) {
  if (blocks.empty()) return;
  const auto count = static_cast<double>(blocks.size());
  const double mean = std::accumulate(blocks.begin(), blocks.end(), 0.0) / count;
  blocks_ += count;
  block_squares_ = std::inner_product(blocks.begin(), blocks.end(), blocks.begin(), block_squares_);
  flights_ += 1.0;
  flight_squares_ += mean * mean;
}

double FittedMeans::expected_bias(std::size_t held_out) const {
  if (blocks_ == 0.0 || held_out == 0) return 0.0;
  const double of_blocks = block_squares_ / blocks_ * (1.0 / static_cast<double>(held_out) + 1.0 / blocks_);
  const double of_flights = flights_ < 2.0 ? 0.0 : flight_squares_ / flights_ * (1.0 + 1.0 / flights_);
  return std::sqrt(std::max(of_blocks, of_flights));
}

}  // namespace pcor::internal
