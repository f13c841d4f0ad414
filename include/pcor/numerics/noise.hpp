#pragma once

#include <cstddef>
#include <vector>

namespace pcor {

/// Consecutive samples of a series that all have a value and are one step apart.
struct Segment {
  std::size_t first = 0;
  std::size_t count = 0;
};

/// The stretches of `values`, where NaN is missing. A time that is more than one and a half usual steps after
/// the one before, or not after it, begins a new stretch: series of several flights may follow each other.
/// `time` (s) has as many entries as `values`, `step` is the usual step, s.
std::vector<Segment> contiguous_segments(const std::vector<double>& values, const std::vector<double>& time,
                                         double step);

/// The standard deviation of a normal distribution whose absolute values have the median of `values`:
/// 1.4826 times the median of |value|. NaN are left out; NaN where nothing is left. Half of the values may
/// be outliers.
double robust_standard_deviation(std::vector<double> values);

/// The noise of a residual: what changes from one sample to the next faster than any effect does.
///
/// Measured from differences r(t+k) - r(t) over k = 1, 2, 4 ... 64 samples: their robust variance D(k) grows
/// with k while the noise remembers itself, and levels off at twice its variance; what goes on growing after
/// that is a model that fails, and does not count. The level is where a doubling of k adds less than 15 %.
/// It is found for each five minutes on its own, since turbulence comes and goes.
struct NoiseFloor {
  double rms = 0.0;  ///< over the whole series, in its unit
  /// Of each sample, in the unit of the series: the level of its five minutes, brought by 15 % (of its
  /// logarithm) towards that of the series. NaN where the series has no value.
  std::vector<double> local_rms{};
  /// For how many samples one independent sample stands, 1 + 2 (rho_1 + rho_2 + ...); at least 1.
  double autocorrelation_time = 1.0;
};

/// @param values the series, NaN where missing; @param stretches its `contiguous_segments`.
/// @param step the usual step, s.
/// NaN for rms where the series has fewer than 30 differences.
NoiseFloor noise_floor(const std::vector<double>& values, const std::vector<Segment>& segments, double step);

/// A stationary process e(t) = a_1 e(t-1) + ... + a_p e(t-p) + innovation.
struct Autoregression {
  std::vector<double> coefficients{};
  double innovation_rms = 0.0;  ///< in the unit of the series
};

/// The process that fits a series best: by Burg's method over all stretches together, of the order (0 to 20)
/// with the least Bayesian information criterion; the search ends after five orders in vain. Every order
/// keeps the process stationary. Values beyond `limit` robust deviations count as if they were at that limit.
Autoregression autoregression(const std::vector<double>& values, const std::vector<Segment>& segments,
                              double limit = 4.5);

/// The sum over all pairs of samples of u(t) C(t-s) v(s), for columns u, v and the autocovariance C of the
/// process: the covariance matrix of the sums (column . noise). Columns are zero where samples are missing,
/// `segments` are the parts of the series without a gap in time.
///
/// @param columns `count` pointers to `samples` values each
/// @return the matrix, row by row
std::vector<double> covariance_of_sums(const Autoregression& noise, const std::vector<const double*>& columns,
                                       const std::vector<Segment>& segments);

}  // namespace pcor
