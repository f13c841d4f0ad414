#include <pcor/residuals/statistics.hpp>

#include <algorithm>
#include <cmath>

#include "numerics/missing.hpp"
#include "residuals/residual_sums.hpp"

namespace pcor {

using namespace internal;

void ResidualSums::add(double residual, double noise, double samples_per_independent) {
  ++samples;
  sum += residual;
  squares += residual * residual;
  noise_squares += noise * noise;
  independent += 1.0 / samples_per_independent;
}

Statistics ResidualSums::statistics() const {
  Statistics result;
  result.samples = samples;
  if (samples == 0) {
    result.bias = result.bias_error = result.rms = result.noise_rms = nan;
    return result;
  }
  const auto count = static_cast<double>(samples);
  result.bias = sum / count;
  result.rms = std::sqrt(squares / count);
  result.noise_rms = std::sqrt(noise_squares / count);
  result.bias_error = independent > 1.0 ? result.scatter() / std::sqrt(independent) : nan;
  return result;
}

double Statistics::rms_over_noise() const { return noise_rms > 0.0 ? rms / noise_rms : nan; }

bool fails_more(const Statistics& a, const Statistics& b) {
  const auto failure = [](const Statistics& s) {
    const double excess = s.rms * s.rms - s.noise_rms * s.noise_rms;
    return std::isnan(excess) ? 0.0 : excess;
  };
  return failure(a) > failure(b);
}

double Statistics::scatter() const { return std::sqrt(std::max(rms * rms - bias * bias, 0.0)); }

Statistics statistics_of(const std::vector<double>& residuals, const NoiseFloor& noise,
                         const std::vector<bool>& used) {
  ResidualSums sums;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (used[i] && !std::isnan(residuals[i]))
      sums.add(residuals[i], noise.local_rms[i], noise.samples_per_independent);
  }
  return sums.statistics();
}

}  // namespace pcor
