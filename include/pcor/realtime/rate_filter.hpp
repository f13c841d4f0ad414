#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include <pcor/physics/constants.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor {

/// Rate of change of evenly spaced samples, or their mean rate over a number of seconds, without noise of
/// short periods.
///
///     R(t) = (x(t) - x(t - s)) / s,  for s = 0 the derivative dx/dt
///
/// x is interpolated by a sinc under a Hann window of six zeros on either side, which removes periods under 1
/// s. tau R is the change of x by a first-order lag of tau, and s R that by a delay of s, at the transmitted
/// periods. Transfer function of the derivative:
///
///     period, s   10      4       3       2.5     2.2     2       1.5     1       0.7
///     at 1 Hz     1.000   0.999   1.010   0.948   0.543   0       -       -       -
///     at 5 Hz     1.000   1.000   1.001   1.000   1.000   0.999   1.006   0.500   0.001
///     at 25 Hz    0.999   1.000   1.001   1.000   0.999   0.998   1.006   0.500   0.000
///
/// A constant gives zero and a straight line its slope. White noise of standard deviation 1 becomes 1.5 per
/// second at 1 Hz and 0.94 at 25 Hz, compared with 35 for the difference of neighbours. Gaps of up to the
/// distance of two zeros are interpolated linearly; beyond longer gaps, and beyond the ends, the series is
/// extended by point reflection about its last sample, but not up to the start of the delay.
///
/// Source: Oppenheim and Schafer, Discrete-Time Signal Processing, ch. 4 and 7.
class RateFilter {
 public:
  static constexpr double usual_period = 1.0;  ///< s
  static constexpr double zeros = 6.0;         ///< zeros of the sinc on either side

  /// @param rate samples per second, positive and finite
  /// @param seconds averaging time of the rate, s; negative: later samples; finite
  /// @param min_period period of half amplitude, s
  explicit RateFilter(double rate, double seconds = 0.0, double min_period = usual_period)
      : shift_(std::abs(seconds) * rate < min_shift ? 0.0 : seconds * rate),
        band_(std::min(1.0, 2.0 / (min_period * rate))),
        bridge_(static_cast<std::size_t>(std::lround(1.0 / band_))) {
    constexpr double little = 1e-3;  // samples
    const double width = std::round(zeros / band_);
    const double late = shift_ == 0.0 ? little : 0.0;
    const double early = shift_ == 0.0 ? -little : -shift_;
    // Ends of the window, on both sides of both positions.
    const double first = std::floor(std::min(0.0, -shift_) - width - 1.0) + 1.0;
    const double last = std::ceil(std::max(0.0, -shift_) + width + 1.0) - 1.0;
    before_ = static_cast<std::size_t>(-first);
    weights_.assign(static_cast<std::size_t>(last - first) + 1, 0.0);
    add_value(late, width, rate / (late - early));
    add_value(early, width, -rate / (late - early));
    filled_.resize(3 * weights_.size());
  }

  /// Number of samples before and after a sample that its rate depends on.
  std::size_t before() const { return before_; }
  std::size_t after() const { return weights_.size() - 1 - before_; }

  /// Variance of the rate for white noise of variance 1, s^-2.
  double gain() const { return std::inner_product(weights_.begin(), weights_.end(), weights_.begin(), 0.0); }

  /// Rate per second at `*sample`, with `earlier` available samples before it and `later` ones after it. NaN
  /// if the sample cannot be interpolated, has no neighbour, or there is no sample `seconds` before it.
  double operator()(const double* sample, std::size_t earlier, std::size_t later) noexcept {
    if (earlier >= before_ && later >= after()) {
      const double rate = sum(sample - before_);
      if (is_finite(rate)) return rate;
    }
    return fill(sample, earlier, later) ? sum(filled_.data() + weights_.size()) : missing<double>();
  }

 private:
  static constexpr double min_shift = 0.02;  // samples, below which a mean rate is the derivative

  double sum(const double* first) const noexcept {
    // Differences from the sample, so that a constant gives exactly zero; four independent sums for
    // instruction-level parallelism.
    const double here = first[before_];
    std::array<double, 4> sums{};
    std::size_t k = 0;
    for (; k + sums.size() <= weights_.size(); k += sums.size()) {
      for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += weights_[k + i] * (first[k + i] - here);
    }
    for (; k < weights_.size(); ++k) sums[0] += weights_[k] * (first[k] - here);
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
  }

  /// Fills missing samples of a window. False if there are no values for this.
  bool fill(const double* sample, std::size_t earlier, std::size_t later) noexcept {
    const auto at = [&](std::size_t position) {
      return sample[static_cast<std::ptrdiff_t>(position) - static_cast<std::ptrdiff_t>(before_)];
    };
    // Samples at or next to the central one, then all on either side up to a long gap.
    const std::size_t begin = before_ - std::min(before_, earlier);
    const std::size_t end = before_ + std::min(after(), later);
    std::size_t first = before_;
    while (first > begin && !is_finite(at(first))) --first;
    std::size_t last = before_;
    while (last < end && !is_finite(at(last))) ++last;
    if (!is_finite(at(first)) || !is_finite(at(last)) || last - first > bridge_ + 1) return false;
    for (std::size_t k = first; k > begin && first - (k - 1) <= bridge_ + 1;) {
      if (is_finite(at(--k))) first = k;
    }
    for (std::size_t k = last; k < end && k + 1 - last <= bridge_ + 1;) {
      if (is_finite(at(++k))) last = k;
    }
    if (first == last) return false;
    // An extrapolation this far from the data is not meaningful.
    const double position = static_cast<double>(before_) - shift_;
    const auto margin = static_cast<double>(bridge_);
    if (position < static_cast<double>(first) - margin || position > static_cast<double>(last) + margin)
      return false;
    double* const filled = filled_.data() + weights_.size();
    std::size_t known = first;
    for (std::size_t k = first; k <= last; ++k) {
      if (!is_finite(at(k))) continue;
      for (std::size_t between = known; between < k; ++between) {
        const double part = static_cast<double>(between - known) / static_cast<double>(k - known);
        filled[between] = at(known) + part * (at(k) - at(known));
      }
      filled[k] = at(k);
      known = k;
    }
    // Outwards on both sides, so that what is turned is there.
    for (std::size_t away = 1; away <= weights_.size(); ++away) {
      *(filled + first - away) = 2.0 * filled[first] - filled[first + away];
      filled[last + away] = 2.0 * filled[last] - *(filled + last - away);
    }
    return true;
  }

  /// Adds `scale` times the weights of the value at `position`, in samples from the central one.
  void add_value(double position, double width, double scale) {
    constexpr double pi = 180.0 * constants::radians_per_degree;
    std::vector<double> taper(weights_.size());
    std::vector<double> value(weights_.size());
    std::array<double, 3> moments{};  // moments of the taper
    double sum = 0.0;
    double first_moment = 0.0;
    const auto from_place = [&](std::size_t k) {
      return static_cast<double>(k) - static_cast<double>(before_) - position;
    };
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      const double from = from_place(k);
      if (std::abs(from) >= width + 1.0) continue;
      taper[k] = 0.5 + 0.5 * std::cos(pi * from / (width + 1.0));
      const double phase = pi * band_ * from;
      value[k] = band_ * (phase == 0.0 ? 1.0 : std::sin(phase) / phase) * taper[k];
      for (std::size_t power = 0; power < moments.size(); ++power)
        moments[power] += taper[k] * std::pow(from, static_cast<double>(power));
      sum += value[k];
      first_moment += value[k] * from;
    }
    // Constants and straight lines are reproduced exactly.
    const double determinant = moments[0] * moments[2] - moments[1] * moments[1];
    const double constant = (moments[2] * (1.0 - sum) + moments[1] * first_moment) / determinant;
    const double slope = -(moments[1] * (1.0 - sum) + moments[0] * first_moment) / determinant;
    for (std::size_t k = 0; k < weights_.size(); ++k)
      weights_[k] += scale * (value[k] + (constant + slope * from_place(k)) * taper[k]);
  }

  double shift_;        // samples
  double band_;         // transmitted fraction of the sampled band
  std::size_t bridge_;  // samples between two zeros
  std::size_t before_ = 0;
  std::vector<double> weights_;
  std::vector<double> filled_;  // a window without missing samples, and as much on either side
};

}  // namespace pcor
