#pragma once

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

// Noise of a series of samples each second that is slower and less tidy than an autoregression.

namespace pcor::test {

struct Nuisance {
  double drift = 0.0;       ///< hPa
  double drift_time = 1.0;  ///< s
  double flicker = 0.0;     ///< rms of 1/f noise in a decade of frequency, hPa
  bool bursts = false;      ///< half a minute with five times a noise of 0.3 hPa, every ten minutes
  bool stuck = false;       ///< the series is constant for a minute
  bool is_off = false;      ///< zero, gain and drift of a pressure are off by draws of their usual doubts
};

inline void add_process(std::vector<double>& series, std::mt19937_64& engine, double rms, double memory) {
  std::normal_distribution<double> normal;
  const double keep = std::exp(-1.0 / memory);
  double value = rms * normal(engine);
  for (double& each : series) {
    each += value;
    value = keep * value + std::sqrt(1.0 - keep * keep) * rms * normal(engine);
  }
}

inline void add_nuisance(std::vector<double>& series, unsigned seed, const Nuisance& nuisance) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  if (nuisance.drift > 0.0) add_process(series, engine, nuisance.drift, nuisance.drift_time);
  // Processes an octave apart of equal rms have a spectrum of 1/f between them; 3.3 octaves are a decade.
  for (double memory = 2.0; nuisance.flicker > 0.0 && memory < 8000.0; memory *= 2.0)
    add_process(series, engine, nuisance.flicker / std::sqrt(3.3), memory);
  if (nuisance.is_off) {
    const double zero = 0.1 * normal(engine);       // hPa, psfd-bias
    const double gain = 1e-4 * normal(engine);      // psfd-gain
    const double per_hour = 0.03 * normal(engine);  // hPa/h, psfd-drift
    for (std::size_t i = 0; i < series.size(); ++i)
      series[i] += zero + gain * series[i] + per_hour * static_cast<double>(i) / 3600.0;
  }
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (nuisance.bursts && i % 600 < 30) series[i] += 1.5 * normal(engine);
    if (nuisance.stuck && i > 3000 && i < 3060) series[i] = series[3000];
  }
}

}  // namespace pcor::test
