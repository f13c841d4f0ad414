#pragma once

#include <cmath>

namespace pcor {

/// True if samples come at the intervals of a rate.
///
/// Deviations of samples from an even clock are accumulated, with a decay time of five samples. Times that
/// jitter by less than a twentieth of a sample are even, and so is a rate error below 2 %; a larger rate
/// error is uneven, and so is a step longer or shorter by a tenth.
class SampleClock {
 public:
  /// @param rate samples in a second
  explicit SampleClock(double rate) : rate_(rate) {}

  void reset() noexcept { ahead_ = 0.0; }

  /// @param step s since the sample before
  bool is_uneven(double step) noexcept {
    constexpr double kept = 0.8;
    constexpr double maximum = 0.1;  // samples
    ahead_ = ahead_ * kept + (step * rate_ - 1.0);
    if (std::abs(ahead_) <= maximum) return false;
    ahead_ = 0.0;
    return true;
  }

 private:
  double rate_;
  double ahead_ = 0.0;  // samples
};

}  // namespace pcor
