#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <pcor/realtime/functor.hpp>

namespace pcor {

/// Rate of change of a quantity from this sample and the one before it, per second.
///
/// Real time knows no later sample, so the rate is that of half a step ago. NaN where this value is missing
/// or infinite; NaN with the bit `after_gap` where there is none before it: at a start, after a gap, and
/// after a value that was missing or infinite.
class RateOfChange final : public Functor {
 public:
  RateOfChange(Quantity quantity, Quantity rate) : RateOfChange(quantity, rate, {Quantity::time, quantity}) {}

  /// The rate of a quantity as it is recorded, for the functor that completes it in place and reads the rate:
  /// it waits for no one.
  static std::unique_ptr<RateOfChange> as_recorded(Quantity quantity, Quantity rate) {
    return std::unique_ptr<RateOfChange>(new RateOfChange(quantity, rate, {Quantity::time}));
  }

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
  RateOfChange(Quantity quantity, Quantity rate, std::vector<Quantity> inputs)
      : Functor(std::move(inputs), {rate}), quantity_(quantity), rate_(rate) {}

  Quantity quantity_;
  Quantity rate_;
  bool started_ = false;
  double previous_time_ = 0.0;
  double previous_value_ = 0.0;
};

}  // namespace pcor
