#pragma once

#include <cmath>

namespace pcor {

/// Whether samples come at the intervals of a rate.
///
/// What a sample is ahead of or behind an even clock is added up and forgotten, over five samples. So times
/// that jitter by less than a tenth of a sample are even, and so is a rate that is less than 2 % off; one
/// that is more is not, nor is one step that is longer or shorter by a tenth.
class SampleClock {
 public:
  /// @param rate samples in a second
  explicit SampleClock(double rate) : rate_(rate) {}

  void reset() noexcept { ahead_ = 0.0; }

  /// @param step s since the sample before
  bool is_uneven(double step) noexcept {
    constexpr double kept = 0.8;
    constexpr double most = 0.1;  // samples
    ahead_ = ahead_ * kept + (step * rate_ - 1.0);
    if (std::abs(ahead_) <= most) return false;
    ahead_ = 0.0;
    return true;
  }

 private:
  double rate_;
  double ahead_ = 0.0;  // samples
};

}  // namespace pcor
