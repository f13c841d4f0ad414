#pragma once

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

// Noise of a series at 1 Hz with drift, 1/f noise, bursts and faults.

namespace pcor::test {

struct Nuisance {
  double drift = 0.0;       ///< hPa
  double drift_time = 1.0;  ///< s
  double flicker = 0.0;     ///< rms of 1/f noise in a decade of frequency, hPa
  bool bursts = false;      ///< noise of 1.5 hPa for 30 s every 10 minutes
  bool stuck = false;       ///< constant values for 60 s
  bool is_off = false;      ///< random zero, gain and drift of a pressure, of typical size
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
  // A sum of processes with equal rms and time constants one octave apart has a 1/f spectrum; a decade
  // has 3.3 octaves.
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
