#pragma once

#include "pcor/realtime/functor.hpp"

namespace pcor {

/// Rate of change of a quantity from this sample and the one before it, per second.
///
/// Real time knows no later sample, so the rate is that of half a step ago. NaN where this value is missing
/// or infinite; NaN with the bit `after_gap` where there is none before it: at a start, after a gap, and
/// after a value that was missing or infinite.
class RateOfChange final : public Functor {
 public:
  RateOfChange(Quantity quantity, Quantity rate)
      : Functor({Quantity::time, quantity}, {rate}), quantity_(quantity), rate_(rate) {}

  void reset() noexcept override { started_ = false; }

  void compute(State<double>& state, QualityFlags& flags) noexcept override {
    const double time = state[Quantity::time];
    const double value = finite_or_missing(state[quantity_]);
    flags.set(!started_, Quality::after_gap);
    state[rate_] = started_ ? (value - previous_value_) / (time - previous_time_) : missing<double>();
    previous_time_ = time;
    previous_value_ = value;
    started_ = !is_missing(value);
  }

 private:
  Quantity quantity_;
  Quantity rate_;
  bool started_ = false;
  double previous_time_ = 0.0;
  double previous_value_ = 0.0;
};

}  // namespace pcor
