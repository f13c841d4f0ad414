#include "residuals/flight_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "numerics/binned_residual.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr double block_length = 300.0;  // s

}  // namespace

std::vector<double> only_at(const std::vector<double>& values, const std::vector<std::size_t>& samples) {
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
  return noise_floor(residual, contiguous_segments(residual, samples.time, samples.step), samples.step);
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
  const BinnedResidual binned(residual, samples.time, samples.step);
  const NoiseModel found = noise_about_mean({binned.bins()}, {binned.means()}, 1);
  sums.sum_variance = binned.variance_of_sum(used, found, 0);
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

Gain gain_between(const FlightSamples& samples, const std::vector<double>& before,
                  const std::vector<double>& after, const NoiseFloor& noise, double window) {
  const double segment = std::max(60.0, 2.0 * window);  // s
  const double weight = window > samples.step ? samples.step / window : 1.0;
  Gain sum;
  double squares = 0.0;
  for (std::size_t i = 0; i < after.size();) {
    const double end = samples.time[i] + segment;
    double gain = 0.0;
    for (; i < after.size() && samples.time[i] < end; ++i) {
      const double deviation = noise.local_rms[i];
      if (!std::isnan(after[i]) && !std::isnan(before[i]) && deviation > 0.0)
        gain += (before[i] * before[i] - after[i] * after[i]) / (deviation * deviation);
    }
    gain *= weight;
    sum.value += gain;
    squares += gain * gain;
  }
  sum.error = std::sqrt(squares);
  return sum;
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
