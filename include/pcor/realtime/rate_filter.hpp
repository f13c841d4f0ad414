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

/// The rate of change of evenly spaced samples, or their mean rate over some seconds, without noise of short
/// periods.
///
///     R(t) = (x(t) - x(t - s)) / s,  for s = 0 the derivative dx/dt
///
/// x is interpolated by a sinc under a Hann window of six zeros on either side, which takes periods under 1 s
/// away. tau R is what a first-order lag of tau, and s R what a delay of s, takes from x: exactly, at all
/// periods that are left. Of the derivative:
///
///     period, s   10      4       3       2.5     2.2     2       1.5     1       0.7
///     at 1 Hz     1.000   0.999   1.010   0.948   0.543   0       -       -       -
///     at 5 Hz     1.000   1.000   1.001   1.000   1.000   0.999   1.006   0.500   0.001
///     at 25 Hz    0.999   1.000   1.001   1.000   0.999   0.998   1.006   0.500   0.000
///
/// A constant gives zero and a straight line its slope. White noise of deviation 1 becomes 1.5 per second at
/// 1 Hz and 0.94 at 25 Hz, where the difference of neighbours has 35. Where samples are missing, or a flight
/// begins, the widest window without them is taken, down to one of a single zero.
///
/// Source: Oppenheim and Schafer, Discrete-Time Signal Processing, ch. 4 and 7.
class RateFilter {
 public:
  static constexpr double usual_period = 1.0;  ///< s
  static constexpr double zeros = 6.0;         ///< of the sinc, on either side

  /// @param rate samples in a second, above zero and finite @param seconds over which the rate is the mean,
  /// s; those to come where below zero; finite @param shortest_period of which half the amplitude is left, s
  explicit RateFilter(double rate, double seconds = 0.0, double shortest_period = usual_period)
      : rate_(rate),
        shift_(std::abs(seconds) * rate < least_shift ? 0.0 : seconds * rate),
        band_(std::min(1.0, 2.0 / (shortest_period * rate))) {
    const auto narrowest = static_cast<std::size_t>(std::lround(1.0 / band_));
    for (auto width = static_cast<std::size_t>(std::lround(zeros / band_)); width >= narrowest; --width)
      windows_.push_back(window(static_cast<double>(width)));
  }

  /// How many samples before and after one take part in its rate.
  std::size_t before() const { return windows_.front().before; }
  std::size_t after() const { return windows_.front().after(); }

  /// What becomes of the variance of white noise, per second squared.
  double gain() const {
    const std::vector<double>& weights = windows_.front().weights;
    return std::inner_product(weights.begin(), weights.end(), weights.begin(), 0.0);
  }

  /// The rate per second at `*sample`, of which `earlier` samples before it and `later` ones after it may be
  /// read. NaN where too many of those next to it, or itself, are missing.
  double operator()(const double* sample, std::size_t earlier, std::size_t later) const noexcept {
    for (const Window& window : windows_) {
      if (window.before > earlier || window.after() > later) continue;
      const double* const from = sample - window.before;
      double sum = 0.0;
      for (std::size_t k = 0; k < window.weights.size(); ++k) sum += window.weights[k] * (from[k] - *sample);
      if (is_finite(sum)) return sum;
    }
    return missing<double>();
  }

 private:
  static constexpr double least_shift = 0.02;  // samples, below which a mean rate is the derivative

  struct Window {
    std::size_t before = 0;  // the sample
    std::vector<double> weights{};
    std::size_t after() const { return weights.size() - 1 - before; }
  };

  Window window(double width) const {
    constexpr double little = 1e-3;  // samples
    const double late = shift_ == 0.0 ? little : 0.0;
    const double early = shift_ == 0.0 ? -little : -shift_;
    Window result;
    const double first = std::min({0.0, std::ceil(late - width), std::ceil(early - width)});
    const double last = std::max({0.0, std::floor(late + width), std::floor(early + width)});
    result.before = static_cast<std::size_t>(-first);
    result.weights.assign(static_cast<std::size_t>(last - first) + 1, 0.0);
    const double scale = rate_ / (late - early);
    add_value(late, width, scale, result);
    add_value(early, width, -scale, result);
    return result;
  }

  /// Adds `scale` times the weights of the value at `place`, in samples from the one in question.
  void add_value(double place, double width, double scale, Window& window) const {
    constexpr double pi = 180.0 * constants::radians_per_degree;
    const std::size_t count = window.weights.size();
    std::vector<double> taper(count);
    std::vector<double> value(count);
    std::array<double, 3> moments{};  // of the taper
    double sum = 0.0;
    double first_moment = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      const double from = static_cast<double>(k) - static_cast<double>(window.before) - place;
      if (std::abs(from) >= width + 1.0) continue;
      taper[k] = 0.5 + 0.5 * std::cos(pi * from / (width + 1.0));
      const double phase = pi * band_ * from;
      value[k] = band_ * (phase == 0.0 ? 1.0 : std::sin(phase) / phase) * taper[k];
      for (std::size_t power = 0; power < moments.size(); ++power)
        moments[power] += taper[k] * std::pow(from, static_cast<double>(power));
      sum += value[k];
      first_moment += value[k] * from;
    }
    // A constant and a straight line pass as they are.
    const double determinant = moments[0] * moments[2] - moments[1] * moments[1];
    const double constant = (moments[2] * (1.0 - sum) + moments[1] * first_moment) / determinant;
    const double slope = -(moments[1] * (1.0 - sum) + moments[0] * first_moment) / determinant;
    for (std::size_t k = 0; k < count; ++k) {
      const double from = static_cast<double>(k) - static_cast<double>(window.before) - place;
      window.weights[k] += scale * (value[k] + (constant + slope * from) * taper[k]);
    }
  }

  double rate_;
  double shift_;                 // samples
  double band_;                  // part of the band of the samples that is left
  std::vector<Window> windows_;  // the widest first
};

}  // namespace pcor
