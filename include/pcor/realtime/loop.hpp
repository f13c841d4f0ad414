#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pcor/realtime/frozen_watch.hpp>
#include <pcor/realtime/functor.hpp>
#include <pcor/realtime/look_ahead.hpp>
#include <pcor/realtime/low_pass.hpp>
#include <pcor/realtime/model_faults.hpp>
#include <pcor/realtime/result_uncertainty.hpp>
#include <pcor/realtime/sample_clock.hpp>
#include <pcor/realtime/stages.hpp>
#include <pcor/realtime/wetness.hpp>

namespace pcor {

/// A stage of a chain as a functor of the sample loop.
template <class Stage>
class StageFunctor final : public Functor {
 public:
  StageFunctor(std::shared_ptr<const Chain> chain, CorrectWith with)
      : Functor(Stage::reads({*chain, with}), Stage::writes({*chain, with})),
        chain_(std::move(chain)),
        with_(with) {}

  void compute(State<double>& state, QualityFlags& flags) noexcept override {
    Stage::compute({*chain_, with_}, state, chain_->parameters().data(), flags);
  }

 private:
  std::shared_ptr<const Chain> chain_;
  CorrectWith with_;
};

/// Whether a loop with a laser filters its temperature, which takes a sum over 12 s for every sample: 300
/// samples at 25 Hz.
enum class LaserFilter { with, without };

/// The host of a sample loop at one rate: runs functors in the order of their dependencies, sample by sample.
///
/// All memory is allocated during construction. `run` does not allocate, throw, lock or read globals. State
/// of functors belongs to this loop, so 1 Hz and 25 Hz use separate loops.
///
///     loop.state()[Quantity::static_pressure] = 702.3;   // every recorded quantity of this sample
///     loop.run(time);
///     use(loop.state()[Quantity::corrected_static_pressure], loop.quality());
///
/// A model with effects of rates of change, such as lags, needs later samples. After `run` the state is then
/// that of the sample `delay()` runs earlier, including inputs and time; missing until that sample exists
/// (bit `awaiting_later_samples`). Rates assume samples at the loop's rate: the bit `uneven_samples` marks
/// samples whose rates include other intervals (`SampleClock`). A frozen input sets `sensor_frozen`
/// (`FrozenWatch`) and is used, without an uncertainty; a frozen laser is missing. To flush the last samples
/// before a gap or the end, call `run` with missing inputs.
class Loop {
 public:
  /// A loop at `rate` samples in a second. A step of more than one and a half samples is a gap.
  explicit Loop(double rate) : clock_(rate), filter_clock_(rate), max_step_(1.5 / rate) {}

  /// Creates a loop that runs `model` on the roles `recorded`: delta-p, corrected pressures, Mach number,
  /// humidity, ambient temperature, airspeed, and, if the laser airspeed is recorded, results of LAMS,
  /// including its filtered temperature (`LowPass`) unless disabled; omit that role to skip the laser. The
  /// rate is at most 10,000 samples per second. Several recorded humidities: the vapour pressure is used,
  /// otherwise the dew point. A recorded ambient temperature is used instead of the recovery temperature.
  /// A missing value is not replaced by that of another role. The reader of model files refuses such roles.
  /// If an uncertainty is given, also the uncertainties of the results (`ResultUncertainty`). Returns nullopt
  /// if the model cannot be used, with the reason in `error`. Variables of formulas that are not quantities
  /// of the library are further inputs, which the host sets or a functor writes: `extra_names` lists them,
  /// also a misspelt one, whose missing value makes the effect missing (bit `effect_input_missing`). With
  /// `CorrectWith::lams` a laser without lock is replaced by the model (`CorrectedPressures`).
  static std::optional<Loop> build(const Model& model, const std::vector<Quantity>& recorded, double rate,
                                   std::string* error, CorrectWith with = CorrectWith::model,
                                   const ModelUncertainty& uncertainty = {},
                                   LaserFilter filter = LaserFilter::with);

  /// Creates a loop from an existing chain whose rates of change have no periods shorter than `periods`; the
  /// delay increases with these.
  static std::optional<Loop> build(std::shared_ptr<const Chain> chain, double rate, std::string* error,
                                   CorrectWith with = CorrectWith::model,
                                   const ModelUncertainty& uncertainty = {},
                                   const ShortestPeriods& periods = {},
                                   LaserFilter filter = LaserFilter::with);

  /// Quantity of the variable `name` for user-defined functors: the existing one, of the library or of a
  /// formula, otherwise a new one. nullopt if the capacity is exhausted.
  std::optional<Quantity> add_variable(const std::string& name) {
    const Quantity quantity = quantity_named(name);
    if (quantity != Quantity::count) return quantity;
    const auto found = std::find(extra_names_.begin(), extra_names_.end(), name);
    const auto number = static_cast<std::size_t>(found - extra_names_.begin());
    if (number == extra_capacity) return std::nullopt;
    if (found == extra_names_.end()) extra_names_.push_back(name);
    return extra_quantity(number);
  }

  /// Adds a functor. The order of adding does not matter; call `order` after the last.
  void add(std::unique_ptr<Functor> functor) { functors_.push_back(std::move(functor)); }

  /// Orders the functors. Returns false without changes if one reads or writes a variable that was not added,
  /// if two functors write one quantity or depend on each other, or if one writes a quantity whose rate of
  /// change the model reads (with `clock-skew` every input of the airspeed), or the liquid water of
  /// `temp-wetting`, because these are read before functors run; `error` names them.
  bool order(std::string* error);

  /// True if some functor writes the quantity.
  bool writes(Quantity quantity) const {
    return std::any_of(functors_.begin(), functors_.end(), [quantity](const auto& functor) {
      const std::vector<Quantity>& outputs = functor->outputs();
      return std::find(outputs.begin(), outputs.end(), quantity) != outputs.end();
    });
  }

  /// The values of a sample: set what is recorded, run, read what is derived.
  State<double>& state() { return state_; }
  const State<double>& state() const { return state_; }

  /// The quality bits of the sample that the state is of.
  QualityFlags quality() const { return quality_; }

  /// Further variables, by name; number i is at `extra_quantity(i)`.
  const std::vector<std::string>& extra_names() const { return extra_names_; }

  /// Delay of the results of a sample, in runs: 0 for a model that reads no rate of change.
  std::size_t delay() const noexcept { return look_ahead_ ? look_ahead_->delay() : 0; }

  /// The time of the sample that was run last, s; NaN before the first and after `reset`.
  double last_time() const noexcept { return previous_time_; }

  /// True if this input of the sample that the state is of is frozen (`FrozenWatch`).
  bool is_frozen(Quantity quantity) const noexcept { return frozen_ && frozen_->is_frozen(quantity); }

  /// Disables the detection of frozen sensors, for hosts that detect them from the whole flight.
  void do_not_watch_sensors() noexcept { frozen_.reset(); }

  /// Clears all earlier samples.
  void reset() noexcept {
    started_ = false;
    previous_time_ = missing<double>();
  }

  /// True if a sample at `time` resets all functors: the first one, one after a gap, and one whose time does
  /// not increase.
  bool is_discontinuity(double time) const noexcept {
    const double step = time - previous_time_;
    return !started_ || !(step > 0.0 && step <= max_step_);
  }

  /// Runs all functors on the sample at `time`, in seconds. Drifts need the time since the first record. A
  /// sample that starts again (not the first, nor the first after `reset`) has the bit `after_gap`, or
  /// `uneven_samples` if its time does not increase, or it or the time before is not finite; with a delay
  /// also `awaiting_later_samples`. If many samples have such a bit, the rate of the loop is too high, and
  /// frozen sensors are not found. Without a delay a rate that is too low sets no bit, and frozen sensors
  /// are reported too early.
  void run(double time) noexcept {
    quality_.clear();
    double step = time - previous_time_;
    if (is_discontinuity(time)) {
      if (started_ || !is_finite(time))
        quality_.set(is_finite(step) && step > max_step_ ? Quality::after_gap : Quality::uneven_samples);
      step = missing<double>();
      for (const auto& functor : functors_) functor->reset();
      if (look_ahead_) look_ahead_->reset();
      if (wetness_) wetness_->reset();
      if (frozen_ && started_)
        frozen_->end();
      else if (frozen_)
        frozen_->reset();
      clock_.reset();
      filter_clock_.reset();
      filter_time_ = missing<double>();
      uneven_ = 0;
    } else if (clock_.is_uneven(step) && look_ahead_) {
      uneven_ = look_ahead_->window();
    }
    started_ = true;
    previous_time_ = time;
    state_[Quantity::time] = time;
    if (wetness_) {
      state_[Quantity::wetness] =
          (*wetness_)(plausible_or_missing(Quantity::liquid_water, state_[Quantity::liquid_water]), step);
    }
    if (uneven_ > 0) {
      --uneven_;
      quality_.set(Quality::uneven_samples);
    }
    if (look_ahead_ && !look_ahead_->exchange(state_, quality_)) {
      quality_.set(Quality::awaiting_later_samples);
      return;
    }
    if (frozen_) quality_.set((*frozen_)(state_), Quality::sensor_frozen);
    if (is_frozen(Quantity::lams_airspeed)) state_[Quantity::lams_airspeed] = missing<double>();
    if (low_pass_ != nullptr) reset_filter_at_uneven_step();
    if (uncertainty_ != nullptr) uncertainty_->keep_recorded(state_);
    for (const auto& functor : functors_) functor->compute(state_, quality_);
    // Without the laser, which is missing.
    if (frozen_ && frozen_->any_but(Quantity::lams_airspeed)) {
      for (const UncertainResult& each : uncertain_results) state_[each.uncertainty] = missing<double>();
    }
  }

 private:
  // The filter sees the samples that leave the look-ahead.
  void reset_filter_at_uneven_step() noexcept {
    const double step = state_[Quantity::time] - filter_time_;
    if (!is_missing(step) && filter_clock_.is_uneven(step)) low_pass_->reset();
    filter_time_ = state_[Quantity::time];
  }

  std::string to_string(Quantity quantity) const {
    return index(quantity) < quantity_count ? std::string(info_of(quantity).name)
                                            : extra_names_[extra_number(quantity)];
  }

  std::optional<LookAhead> look_ahead_;
  std::optional<Wetness> wetness_;
  std::optional<FrozenWatch> frozen_;
  SampleClock clock_;
  SampleClock filter_clock_;
  std::size_t uneven_ = 0;                    // remaining runs whose rates of change include uneven samples
  LowPass* low_pass_ = nullptr;               // one of the functors
  ResultUncertainty* uncertainty_ = nullptr;  // likewise
  std::vector<std::unique_ptr<Functor>> functors_;
  std::vector<Quantity> stage_outputs_;  // written by the functors of the model
  std::vector<std::string> extra_names_;
  State<double> state_;
  QualityFlags quality_;
  double max_step_;
  double previous_time_ = missing<double>();
  double filter_time_ = missing<double>();  // time of the filter's previous sample
  bool started_ = false;
};

inline bool Loop::order(std::string* error) {
  const auto fail = [error](std::string why) {
    if (error != nullptr) *error = std::move(why);
    return false;
  };
  // The functor that is still to write each quantity, if any.
  std::array<const Functor*, state_capacity> writer{};
  for (const auto& functor : functors_) {
    for (const std::vector<Quantity>* const quantities : {&functor->inputs(), &functor->outputs()}) {
      for (const Quantity quantity : *quantities) {
        if (quantity == Quantity::count) {
          return fail(
              "a functor reads or writes Quantity::count, which quantity_named returns for an unknown name; "
              "correct the name");
        }
        if (index(quantity) > quantity_count && extra_number(quantity) >= extra_names_.size()) {
          return fail("a functor reads or writes extra_quantity(" + std::to_string(extra_number(quantity)) +
                      "), but the loop has " + std::to_string(extra_names_.size()) +
                      " further variable(s); add it with add_variable");
        }
      }
    }
    for (const Quantity output : functor->outputs()) {
      const bool is_of_stage =
          std::find(stage_outputs_.begin(), stage_outputs_.end(), output) != stage_outputs_.end();
      if (writer[index(output)] != nullptr) {
        return fail("two functors write '" + to_string(output) + "'" +
                    (is_of_stage ? ", one of them a stage of the model; write another variable"
                                 : "; combine them in one functor"));
      }
      const bool changes_over_time =
          (look_ahead_ && look_ahead_->reads(output)) || (wetness_ && output == Quantity::liquid_water);
      if (changes_over_time && !is_of_stage) {
        return fail(
            "a functor writes '" + to_string(output) +
            "', which the model reads before functors run, for a rate of change or the wetness; change "
            "it before the run");
      }
      writer[index(output)] = functor.get();
    }
  }
  const auto awaited = [&writer](const Functor& functor) -> const Quantity* {
    for (const Quantity& input : functor.inputs()) {
      const Functor* const other = writer[index(input)];
      if (other != nullptr && other != &functor) return &input;
    }
    return nullptr;
  };
  // Follows dependencies until it is inside a cycle, then traverses the cycle once.
  const auto cycle_from = [&](std::size_t start) {
    const auto next = [&](const Quantity* quantity) { return awaited(*writer[index(*quantity)]); };
    const Quantity* quantity = awaited(*functors_[start]);
    for (std::size_t i = 0; i < functors_.size(); ++i) quantity = next(quantity);
    const Quantity first = *quantity;
    std::string circle = "'" + to_string(first) + "'";
    do {
      quantity = next(quantity);
      circle += " needs '" + to_string(*quantity) + "'";
      if (*quantity != first) circle += ", which";
    } while (*quantity != first);
    return circle;
  };
  std::vector<std::size_t> waiting(functors_.size());
  std::iota(waiting.begin(), waiting.end(), std::size_t{0});
  std::vector<std::size_t> ordered;
  while (!waiting.empty()) {
    const auto ready = std::find_if(waiting.begin(), waiting.end(), [&](std::size_t number) {
      return awaited(*functors_[number]) == nullptr;
    });
    if (ready == waiting.end()) return fail("functors wait for each other: " + cycle_from(waiting.front()));
    for (const Quantity output : functors_[*ready]->outputs()) writer[index(output)] = nullptr;
    ordered.push_back(*ready);
    waiting.erase(ready);
  }
  std::vector<std::unique_ptr<Functor>> functors;
  for (const std::size_t number : ordered) functors.push_back(std::move(functors_[number]));
  functors_ = std::move(functors);
  return true;
}

inline std::optional<Loop> Loop::build(const Model& model, const std::vector<Quantity>& recorded, double rate,
                                       std::string* error, CorrectWith with,
                                       const ModelUncertainty& uncertainty, LaserFilter filter) {
  BindingError why;
  std::optional<Chain> chain = Chain::build(model, recorded, &why);
  const std::string fault = chain ? fault_of(model) : why.message();
  if (!fault.empty()) {
    if (error != nullptr) *error = fault;
    return std::nullopt;
  }
  return build(std::make_shared<const Chain>(std::move(*chain)), rate, error, with, uncertainty, {}, filter);
}

/// True if the arithmetic of the compiled program keeps NaN and infinity. Fast-math options, which a pragma
/// or an attribute can set without a macro, do not. Defined here, after the headers that a
/// program may include before such a pragma.
inline bool arithmetic_keeps_nan() noexcept {
  const volatile double zero = 0.0;
  const volatile double maximum = std::numeric_limits<double>::max();
  const double nan = zero / zero;
  const double beyond = maximum * maximum;
  return is_missing(nan) && !is_finite(nan) && !is_finite(beyond) && !is_missing(beyond) && !(nan < 1.0) &&
         !(nan > 1.0) && !(nan <= 1.0 || nan >= 1.0) && is_missing(nan * zero + maximum) &&
         beyond > std::numeric_limits<double>::max();
}

inline std::optional<Loop> Loop::build(std::shared_ptr<const Chain> chain, double rate, std::string* error,
                                       CorrectWith with, const ModelUncertainty& uncertainty,
                                       const ShortestPeriods& periods, LaserFilter filter) {
  const auto fail = [error](std::string why) {
    if (error != nullptr) *error = std::move(why);
    return std::nullopt;
  };
  const auto text_of = detail::text_of_number;
  if (!arithmetic_keeps_nan()) {
    return fail(
        "this program is compiled with fast mathematics, which loses the NaN of missing values; remove "
        "-ffast-math, -ffinite-math-only and similar pragmas");
  }
  constexpr double max_rate = 1e4;  // samples/s, ten times that of the fastest recordings
  if (!(rate > 0.0 && rate <= max_rate)) {
    return fail("the rate of the loop is " + text_of(rate) + " samples/s; give a number above 0, at most " +
                text_of(max_rate));
  }
  if (with == CorrectWith::lams && !chain->has_lams()) {
    return fail("correction with LAMS needs the role 'lams_airspeed', which" + std::string(not_recorded));
  }
  Loop loop(rate);
  for (const std::string& name : chain->extra_names()) loop.add_variable(name);
  constexpr double longest = 60.0;  // s, the bounds of clock-skew
  if (const double skew = chain->time_of(Quantity::airspeed_rate); !(std::abs(skew) <= longest)) {
    return fail("the coefficient 'seconds' of clock-skew is " + text_of(skew) + " s; give -60 to 60 s");
  }
  if (chain->derives(Quantity::wetness)) {
    const double drying = chain->time_of(Quantity::wetness);
    if (!(drying >= 0.0 && drying <= Wetness::longest))
      return fail("the coefficient 'drying' of temp-wetting is " + text_of(drying) + " s; give 0 to 600 s");
    loop.wetness_.emplace(rate, drying);
  }
  loop.frozen_.emplace(*chain, rate);
  loop.look_ahead_ = LookAhead::build(chain, rate, periods);
  Stages::each([&](auto stage) {
    auto functor = std::make_unique<StageFunctor<decltype(stage)>>(chain, with);
    if (functor->outputs().empty()) return;
    loop.stage_outputs_.insert(loop.stage_outputs_.end(), functor->outputs().begin(),
                               functor->outputs().end());
    loop.add(std::move(functor));
  });
  if (chain->has_lams() && filter == LaserFilter::with) {
    auto low_pass =
        std::make_unique<LowPass>(Quantity::lams_temperature, Quantity::filtered_lams_temperature, rate);
    loop.low_pass_ = low_pass.get();
    loop.add(std::move(low_pass));
  }
  if (uncertainty.has_systematic() || uncertainty.has_random()) {
    auto functor = ResultUncertainty::build(*chain, uncertainty, with, error,
                                            loop.look_ahead_ ? &*loop.look_ahead_ : nullptr);
    if (functor == nullptr) return std::nullopt;
    loop.uncertainty_ = functor.get();
    loop.add(std::move(functor));
  }
  if (!loop.order(error)) return std::nullopt;
  return loop;
}

}  // namespace pcor
