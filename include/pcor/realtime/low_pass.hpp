#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <pcor/model/plausible.hpp>
#include <pcor/physics/constants.hpp>
#include <pcor/physics/scalar.hpp>
#include <pcor/realtime/functor.hpp>

namespace pcor {

/// Low-pass filter that removes periods under 3 s without phase shift or bias.
///
/// Weighted mean over 6 s before and 6 s after a sample. The weights are those of a sinc of half amplitude at
/// a period of 3 s under a Hamming window, normalised to 1 and symmetric: constants and straight lines pass
/// exactly, without phase shift. Transmitted amplitude:
///
///     period, s   12      8       6       5       4      3      2.5    2.2     2       1.5    1
///     at 1 Hz     1.005   1.001   1.002   1.007   0.957  0.503  0.094  -0.001  0.001   -      -
///     at 25 Hz    1.005   1.003   1.003   0.998   0.927  0.500  0.132  0.012   -0.003  0.001  0.000
///
/// Periods of 6 s and above keep their amplitude within 0.6 %; periods of 2.2 s and below are reduced to 1.2
/// % or less. At 1 Hz the shortest period is 2 s; shorter ones are aliased, and no filter can remove them. A
/// window of 4 s on either side would leave 2 % at 2 s and remove 2 % at 6 s; a window of 8 s would be
/// steeper, with 2 s more delay.
///
/// The value is that of the sample `delay` samples earlier, assuming even sampling. It is missing if that
/// sample is missing, which its quality bits report. A sample before and one after it at the same distance
/// are used in pairs, or not at all if one of them is missing, so that straight lines still pass exactly. If
/// the sum of the weights used is less than half, the value is missing, with the bit
/// `filter_window_incomplete` of that earlier sample, not of the current one. An incomplete window filters
/// less. Implausible results of overshoot are missing, too. After a reset all earlier samples are missing.
/// The bit is set until the first sample after a reset leaves the filter.
///
/// Source: memo, recommendation 6; window: Oppenheim and Schafer, Discrete-Time Signal Processing, ch. 7.
class LowPass final : public Functor {
 public:
  static constexpr double cutoff_period = 3.0;  ///< s, period of half amplitude
  static constexpr double half_window = 6.0;    ///< s

  /// Filters `quantity` at `rate` samples in a second, above zero and finite, into `filtered`.
  LowPass(Quantity quantity, Quantity filtered, double rate)
      : Functor({quantity}, {filtered}),
        quantity_(quantity),
        filtered_(filtered),
        weights_(weights_at(rate)),
        length_(2 * delay() + 1),
        samples_(2 * length_, missing<double>()) {}

  /// Delay of the filtered value in samples, at `rate` samples per second: 6 at 1 Hz, 150 at 25 Hz; in
  /// seconds, delay/rate. Zero, without filtering, if samples are too far apart to resolve periods under 3 s.
  static std::size_t delay(double rate) {
    const bool holds_short_periods = rate * cutoff_period > 2.0;
    return holds_short_periods ? static_cast<std::size_t>(std::lround(half_window * rate)) : 0;
  }

  std::size_t delay() const { return weights_.size() - 1; }

  void reset() noexcept override {
    std::fill(samples_.begin(), samples_.end(), missing<double>());
    young_ = delay();
  }

  void compute(State<double>& state, QualityFlags& flags) noexcept override {
    // Each sample is kept twice, so that the window lies in one piece, the oldest sample first.
    samples_[next_] = samples_[next_ + length_] = finite_or_missing(state[quantity_]);
    next_ = (next_ + 1) % length_;
    const double* const centre = samples_.data() + next_ + delay();
    const double value = plausible_or_missing(filtered_, filtered(centre));
    flags.set(is_missing(value) && (young_ > 0 || !is_missing(*centre)), Quality::filter_window_incomplete);
    if (young_ > 0) --young_;
    state[filtered_] = value;
  }

 private:
  // The weight of the sample in the middle and of those 1, 2 ... samples from it.
  static std::vector<double> weights_at(double rate) {
    constexpr double pi = 180.0 * constants::radians_per_degree;
    const std::size_t half_width = delay(rate);
    std::vector<double> weights{1.0};
    double sum = 1.0;
    for (std::size_t i = 1; i <= half_width; ++i) {
      const auto from_middle = static_cast<double>(i);
      const double phase = 2.0 * pi * from_middle / (rate * cutoff_period);
      const double window = 0.54 + 0.46 * std::cos(pi * from_middle / static_cast<double>(half_width + 1));
      weights.push_back(window * std::sin(phase) / phase);
      sum += 2.0 * weights.back();
    }
    for (double& weight : weights) weight /= sum;
    return weights;
  }

  // Departures from the middle are added up, so that a constant passes to the last bit.
  double filtered(const double* centre) const noexcept {
    double sum = 0.0;
    double present = weights_.front();
    for (std::size_t i = 1; i < weights_.size(); ++i) {
      const double departure = (*(centre - i) - *centre) + (*(centre + i) - *centre);
      if (is_missing(departure)) continue;
      sum += weights_[i] * departure;
      present += 2.0 * weights_[i];
    }
    return present < 0.5 ? missing<double>() : finite_or_missing(*centre + sum / present);
  }

  Quantity quantity_;
  Quantity filtered_;
  std::vector<double> weights_;
  std::size_t length_;
  std::vector<double> samples_;
  std::size_t next_ = 0;
  std::size_t young_ = delay();  // samples until there is one in the middle of the window
};

}  // namespace pcor
