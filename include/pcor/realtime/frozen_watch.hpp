#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <pcor/physics/scalar.hpp>
#include <pcor/realtime/chain.hpp>

namespace pcor {

/// Quantities that always vary in flight; flaps and liquid water may be constant.
inline constexpr std::array always_varying{Quantity::static_pressure,
                                           Quantity::dynamic_pressure,
                                           Quantity::radome_dynamic_pressure,
                                           Quantity::attack_differential_pressure,
                                           Quantity::sideslip_differential_pressure,
                                           Quantity::attack,
                                           Quantity::sideslip,
                                           Quantity::recovery_temperature,
                                           Quantity::ambient_temperature,
                                           Quantity::lams_airspeed};

/// Detects a constant sensor, sample by sample.
///
/// The permitted duration of a constant value follows from the resolution, the smallest step observed. If the
/// noise is at least three such steps, the sensor is frozen after 20 samples and 5 s of one value, or, if
/// more, 20 times its usual time at one value, or five times that of a typical sample. Otherwise, and with
/// fewer than 50 known values, it is frozen after `longest`. A run of one value has the weight of its
/// samples.
class SteadyValue {
 public:
  /// @param rate samples in a second
  /// @param longest time that a coarse sensor may have one value, s; infinite: its noise must be known
  SteadyValue(double rate, double longest)
      : rate_(rate),
        longest_time_(longest),
        fewest_(static_cast<std::size_t>(std::max(5.0 * rate, 20.0))),
        longest_(static_cast<std::size_t>(std::min(std::max(longest * rate, 20.0), 1e9))) {}

  void reset() noexcept { *this = SteadyValue(rate_, longest_time_); }

  /// Ends the run of one value, as on the ground.
  void end() noexcept {
    last_ = missing<double>();
    length_ = 0;
  }

  /// Adds a sample, which must not be missing. True if the sensor is frozen.
  bool operator()(double value) noexcept {
    if (value == last_) {
      ++length_;
      if (length_ == fewest_) limit_ = limit();
      return is_frozen();
    }
    if (length_ > 0) end_of_run(value - last_);
    last_ = value;
    length_ = 1;
    return false;
  }

 private:
  static constexpr std::size_t min_values = 50;  // required for typical values
  static constexpr double noisy = 3.0;           // steps of resolution in a second difference
  static constexpr double part = 1.0 / 64.0;     // weight of a sample in a running mean

  bool is_frozen() const noexcept { return length_ >= fewest_ && length_ >= limit_; }

  void end_of_run(double step) noexcept {
    double weight = part;
    if (length_ > 1) {
      last_step_ = 0.0;
      if (!is_frozen()) weight = std::min(1.0, part * static_cast<double>(length_));
    }
    if (!is_frozen()) lengths_[runs_++ % lengths_.size()] = length_;
    resolution_ = std::min(resolution_, std::abs(step));
    const double bend = std::abs(step - last_step_);
    is_bent_ += weight * ((bend >= noisy * resolution_ ? 1.0 : 0.0) - is_bent_);
    last_step_ = step;
  }

  std::size_t limit() const noexcept {
    if (runs_ < min_values || is_bent_ < 0.5) return longest_;
    const std::size_t count = std::min(runs_, lengths_.size());
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto length = static_cast<double>(lengths_[i]);
      sum += length;
      squares += length * length;
    }
    const double usual = std::max(20.0 * sum / static_cast<double>(count), 5.0 * squares / sum);
    return std::min(longest_, static_cast<std::size_t>(std::max(usual, static_cast<double>(fewest_))));
  }

  double rate_;
  double longest_time_;                    // s
  std::size_t fewest_;                     // samples
  std::size_t longest_;                    // samples
  std::array<std::size_t, 64> lengths_{};  // lengths of the last runs of one value, in samples
  std::size_t runs_ = 0;
  std::size_t limit_ = 0;
  std::size_t length_ = 0;
  double last_ = missing<double>();
  double last_step_ = 0.0;
  double resolution_ = std::numeric_limits<double>::infinity();
  double is_bent_ = 0.0;  // the part of samples whose second difference is large
};

/// Detects inputs of a chain that are frozen in flight, among those that always vary: after 20 samples and
/// five seconds, a coarse one after five minutes. A missing value does not count: the values before and after
/// it are neighbours. Does not allocate after construction.
class FrozenWatch {
 public:
  /// @param rate samples in a second
  FrozenWatch(const Chain& chain, double rate) {
    for (const Quantity quantity : always_varying) {
      if (chain.recorded(quantity)) sensors_.push_back({quantity, {rate, 300.0}});
    }
  }

  void reset() noexcept {
    end();
    for (Sensor& sensor : sensors_) sensor.value.reset();
  }

  /// Ends the runs of one value, as at a gap. The usual noise stays known.
  void end() noexcept {
    any_frozen_ = false;
    for (Sensor& sensor : sensors_) {
      sensor.value.end();
      sensor.is_frozen = false;
    }
  }

  /// True if the quantity was frozen at the last sample.
  bool is_frozen(Quantity quantity) const noexcept {
    return any_frozen_ && std::any_of(sensors_.begin(), sensors_.end(), [quantity](const Sensor& sensor) {
             return sensor.quantity == quantity && sensor.is_frozen;
           });
  }

  /// True if a quantity other than `excluded` was frozen at the last sample.
  bool any_but(Quantity excluded) const noexcept {
    return any_frozen_ && std::any_of(sensors_.begin(), sensors_.end(), [excluded](const Sensor& sensor) {
             return sensor.quantity != excluded && sensor.is_frozen;
           });
  }

  /// True if one of them is frozen at this sample.
  bool operator()(const State<double>& state) noexcept {
    const double q = state[Quantity::dynamic_pressure];
    any_frozen_ = false;
    if (is_missing(plausible_or_missing(Quantity::dynamic_pressure, q))) {
      for (Sensor& sensor : sensors_) sensor.is_frozen = false;
    } else if (q < min_flight_pressure) {
      end();
    } else {
      for (Sensor& sensor : sensors_) {
        const double value = state[sensor.quantity];
        sensor.is_frozen = !is_missing(plausible_or_missing(sensor.quantity, value)) && sensor.value(value);
        any_frozen_ = any_frozen_ || sensor.is_frozen;
      }
    }
    return any_frozen_;
  }

 private:
  struct Sensor {
    Quantity quantity;
    SteadyValue value;
    bool is_frozen = false;
  };

  std::vector<Sensor> sensors_;
  bool any_frozen_ = false;
};

}  // namespace pcor
