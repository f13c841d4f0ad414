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

/// Low-pass filter that takes away periods under 3 s and neither shifts nor biases what it leaves.
///
/// A weighted mean over 6 s before and 6 s after a sample. The weights are those of a sinc of half amplitude
/// at a period of 3 s under a Hamming window, their sum is 1, and they are the same forwards and backwards:
/// a constant and a straight line pass exactly, and no period is moved in time. The amplitude that is left:
///
///     period, s   12      8       6       5       4      3      2.5    2.2     2       1.5    1
///     at 1 Hz     1.005   1.001   1.002   1.007   0.957  0.503  0.094  -0.001  0.001   -      -
///     at 25 Hz    1.005   1.003   1.003   0.998   0.927  0.500  0.132  0.012   -0.003  0.001  0.000
///
/// So periods of 6 s and above keep their amplitude within 0.6 %, and of those of 2.2 s and below 1.2 % or
/// less is left. At 1 Hz there is no shorter period than 2 s: what the samples hold of shorter ones looks
/// like a longer one, and no filter can tell. A window of 4 s either side would leave 2 % at 2 s and take
/// 2 % at 6 s; one of 8 s would be steeper, and later by 2 s.
///
/// Real time knows no later sample, so the value is that of the sample `delay` samples ago, as if every step
/// had the length of the rate. It is missing where that sample is, which was told at its time. A sample
/// before and one after it, as far away, count together or, where one of them is missing, not at all, so that
/// lines still pass exactly. Where the weights that count sum up to less than half, the value is
/// missing, and the bit `filter_window_incomplete` says so: of that earlier sample, not of the one that is
/// being run. With part of its window the filter takes away less. Where it overshoots beyond what is
/// believed of the result, that is missing too. After a reset all earlier samples are missing.
///
/// Source: memo, recommendation 6; window: Oppenheim and Schafer, Discrete-Time Signal Processing, ch. 7.
class LowPass final : public Functor {
 public:
  static constexpr double cutoff_period = 3.0;  ///< s, at which half the amplitude is left
  static constexpr double half_window = 6.0;    ///< s

  /// Filters `quantity` at `rate` samples in a second, above zero and finite, into `filtered`.
  LowPass(Quantity quantity, Quantity filtered, double rate)
      : Functor({quantity}, {filtered}),
        quantity_(quantity),
        filtered_(filtered),
        weights_(weights_at(rate)),
        length_(2 * delay() + 1),
        samples_(2 * length_, missing<double>()) {}

  /// How many samples ago the filtered value was, at `rate` samples in a second: 6 at 1 Hz, 150 at 25 Hz. In
  /// seconds it is that over the rate. Zero, and the filter changes nothing, where samples are too far apart
  /// to hold periods under 3 s.
  static std::size_t delay(double rate) {
    const bool holds_short_periods = rate * cutoff_period > 2.0;
    return holds_short_periods ? static_cast<std::size_t>(std::lround(half_window * rate)) : 0;
  }

  std::size_t delay() const { return weights_.size() - 1; }

  void reset() noexcept override {
    std::fill(samples_.begin(), samples_.end(), missing<double>());
    broken_ = 0;
  }

  /// Forgets the samples, as after a step of another length. Values that are missing for it have the bit
  /// `filter_window_incomplete`.
  void break_window() noexcept {
    reset();
    broken_ = delay();
  }

  void compute(State<double>& state, QualityFlags& flags) noexcept override {
    // Each sample is kept twice, so that the window lies in one piece, the oldest sample first.
    samples_[next_] = samples_[next_ + length_] = finite_or_missing(state[quantity_]);
    next_ = (next_ + 1) % length_;
    const double* const centre = samples_.data() + next_ + delay();
    const double value = plausible_or_missing(filtered_, filtered(centre));
    flags.set(is_missing(value) && (broken_ > 0 || !is_missing(*centre)), Quality::filter_window_incomplete);
    if (broken_ > 0) --broken_;
    state[filtered_] = value;
  }

 private:
  // The weight of the sample in the middle and of those 1, 2 ... samples from it.
  static std::vector<double> weights_at(double rate) {
    constexpr double pi = 180.0 * constants::radians_per_degree;
    const std::size_t reach = delay(rate);
    std::vector<double> weights{1.0};
    double sum = 1.0;
    for (std::size_t i = 1; i <= reach; ++i) {
      const auto from_middle = static_cast<double>(i);
      const double phase = 2.0 * pi * from_middle / (rate * cutoff_period);
      const double window = 0.54 + 0.46 * std::cos(pi * from_middle / static_cast<double>(reach + 1));
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
  std::size_t broken_ = 0;  // samples until the window holds no step of another length
};

}  // namespace pcor
