#pragma once

#include <cstddef>
#include <vector>

namespace pcor {

/// Consecutive samples of a series that all have a value and are one step apart.
struct Segment {
  std::size_t first = 0;
  std::size_t count = 0;
};

/// Contiguous segments of `values`; NaN is missing. A time more than 1.5 usual steps after the previous one,
/// or not after it, starts a new segment: series of several flights may be concatenated. `time` (s) has as
/// many entries as `values`, `step` is the usual step, s.
std::vector<Segment> contiguous_segments(const std::vector<double>& values, const std::vector<double>& time,
                                         double step);

/// Robust standard deviation: 1.4826 times the median of |value|, exact for a normal distribution. NaN are
/// ignored; NaN if there are no values. Up to half of the values may be outliers.
double robust_standard_deviation(std::vector<double> values);

/// Noise of a residual: variations from sample to sample faster than those of any effect.
///
/// Estimated from differences r(t+k) - r(t) over k = 1, 2, 4 ... 64 samples: their robust variance D(k) grows
/// with k within the correlation time of the noise, and levels off at twice its variance; growth beyond that
/// is due to errors of the model and is not included. The level is reached if doubling k adds less than 15 %.
/// Estimated for each five minutes separately, because turbulence is intermittent.
struct NoiseFloor {
  double rms = 0.0;  ///< rms over the whole series, in its unit
  /// Noise of each sample, in the unit of the series: the level of its five minutes, shrunk by 15 % (of its
  /// logarithm) towards that of the series. NaN if the series has no value.
  std::vector<double> local_rms{};
  /// Integrated autocorrelation time, in samples, 1 + 2 (rho_1 + rho_2 + ...); at least 1.
  double autocorrelation_time = 1.0;
};

/// @param values the series, NaN if missing; its differences are within its `contiguous_segments`
/// @param time s, as many entries as `values`; @param step the usual step, s
/// NaN for rms if the series has fewer than 30 differences.
NoiseFloor noise_floor(const std::vector<double>& values, const std::vector<double>& time, double step);

/// Coefficients a_1 ... a_p of the stationary process e(t) = a_1 e(t-1) + ... + a_p e(t-p) + innovation
/// fitted to a series: Burg's method over all segments together, order 0 to `max_order` with the least
/// Bayesian information criterion; the search stops after five orders without improvement. All orders are
/// stationary. Values beyond 4.5 robust standard deviations are set to that limit.
std::vector<double> autoregression(const std::vector<double>& values, const std::vector<Segment>& segments,
                                   std::size_t max_order = 20);

}  // namespace pcor
