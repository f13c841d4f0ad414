#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <pcor/realtime/rate_filter.hpp>
#include <pcor/realtime/stages.hpp>

namespace pcor {

/// The shortest periods, s, that some rates of change have, by their noise; others have
/// `RateFilter::usual_period`.
using ShortestPeriods = std::vector<std::pair<Quantity, double>>;

/// Value of a recorded quantity for its rate of change: NaN if it is implausible, or an impossible pressure,
/// which would affect the rates of its neighbours.
inline double usable_for_rates(Quantity quantity, double value) noexcept {
  constexpr double min_dynamic_pressure = -50.0;  // hPa; noise and wind on the ramp are far above
  const bool is_impossible = (quantity == Quantity::static_pressure && value < Chain::min_static_pressure) ||
                             (quantity == Quantity::dynamic_pressure && value < min_dynamic_pressure);
  return is_impossible ? missing<double>() : plausible_or_missing(quantity, value);
}

/// Delays samples until the later samples required for their rates of change are available (`RateFilter`): a
/// causal rate would be late, or noisy.
///
/// Belongs to a chain that reads rates. Rates of recorded quantities are derivatives. The rate of the
/// airspeed is computed along the laser beam, if there is a laser, from the corrected pressures, as the mean
/// over the delay of the laser's clock, if the model has one, without the contributions of lag effects to the
/// pressures. Does not allocate after `build`.
class LookAhead {
 public:
  /// Look-ahead buffer for `chain` at `rate` samples per second; nullopt if the chain reads no rate of
  /// change.
  static std::optional<LookAhead> build(const std::shared_ptr<const Chain>& chain, double rate,
                                        const ShortestPeriods& periods = {}) {
    const auto period_of = [&periods](Quantity quantity) {
      for (const auto& [each, period] : periods) {
        if (each == quantity) return period;
      }
      return RateFilter::usual_period;
    };
    LookAhead result(chain);
    for (const Rate& each : rates) {
      if (chain->derives(each.rate))
        result.changes_.push_back(
            {each.quantity, each.rate, RateFilter(rate, 0.0, period_of(each.rate)), {}});
    }
    if (chain->derives(Quantity::airspeed_rate)) {
      result.changes_.push_back({Quantity::corrected_airspeed,
                                 Quantity::airspeed_rate,
                                 RateFilter(rate, chain->time_of(Quantity::airspeed_rate)),
                                 {}});
    }
    if (result.changes_.empty()) return std::nullopt;
    result.take_memory();
    return result;
  }

  /// Delay of the output in samples at this rate: 6 at 1 Hz, 75 at 25 Hz, plus the lead of the laser's clock,
  /// and three of its shortest periods if these are longer than usual.
  std::size_t delay() const { return delay_; }

  /// Number of samples in the window of a rate.
  std::size_t window() const { return before_ + 1 + delay_; }

  /// True if a rate of change depends on the recorded quantity.
  bool reads(Quantity quantity) const {
    return std::any_of(changes_.begin(), changes_.end(), [&](const Change& change) {
      const Quantities sources = MeasuredQuantities::sources(*chain_, change.rate);
      return std::find(sources.begin(), sources.end(), quantity) != sources.end();
    });
  }

  /// Standard deviation of a rate of change, per second, for white noise of standard deviation 1 of its
  /// quantity; 0 for a rate that is not computed.
  double noise_of(Quantity rate) const {
    for (const Change& change : changes_) {
      if (change.rate == rate) return std::sqrt(change.filter.gain());
    }
    return 0.0;
  }

  /// Clears all samples.
  void reset() noexcept {
    entered_ = 0;
    for (Change& change : changes_) std::fill(change.values.begin(), change.values.end(), missing<double>());
  }

  /// Pushes a sample and returns the one from `delay` samples before, with its rates of change. False, with
  /// all values missing, if there is no such sample yet. The bit `after_gap` marks a rate with too few
  /// neighbours, as after a gap or a missing input of the airspeed.
  bool exchange(State<double>& state, QualityFlags& flags) noexcept {
    const std::size_t length = window();
    for (Change& change : changes_) {
      // Each value is stored twice, so that the window is contiguous in time order.
      const double value = change.of == Quantity::corrected_airspeed
                               ? airspeed_along_beam(state)
                               : usable_for_rates(change.of, state[change.of]);
      change.values[next_] = change.values[next_ + length] = value;
    }
    next_ = (next_ + 1) % length;
    samples_[entered_ % samples_.size()] = state;
    ++entered_;
    if (entered_ <= delay_) {
      state = State<double>();
      return false;
    }
    state = samples_[(entered_ - 1 - delay_) % samples_.size()];
    const std::size_t earlier = std::min(entered_ - 1 - delay_, before_);
    for (Change& change : changes_) {
      const double* const centre = change.values.data() + next_ + before_;
      state[change.rate] = change.filter(centre, earlier, delay_);
      const bool is_there = change.of == Quantity::corrected_airspeed || !is_missing(*centre);
      flags.set(is_missing(state[change.rate]) && is_there, Quality::after_gap);
    }
    return true;
  }

 private:
  /// A quantity and its rate, of the last samples.
  struct Change {
    Quantity of;
    Quantity rate;
    RateFilter filter;
    std::vector<double> values;
  };

  explicit LookAhead(std::shared_ptr<const Chain> chain) : chain_(std::move(chain)) {}

  void take_memory() {
    for (const Change& change : changes_) {
      before_ = std::max(before_, change.filter.before());
      delay_ = std::max(delay_, change.filter.after());
    }
    samples_.resize(delay_ + 1);
    for (Change& change : changes_) change.values.assign(2 * window(), missing<double>());
  }

  double airspeed_along_beam(State<double> state) const noexcept {
    for (const Change& change : changes_) state[change.rate] = 0.0;
    return finite_or_missing(chain_->airspeed_along_beam(state, chain_->parameters().data()));
  }

  std::shared_ptr<const Chain> chain_;
  std::vector<Change> changes_;
  std::vector<State<double>> samples_;  // latest samples without rates
  std::size_t before_ = 0;
  std::size_t delay_ = 0;
  std::size_t next_ = 0;     // index in the values of the changes
  std::size_t entered_ = 0;  // samples since the last reset
};

}  // namespace pcor
