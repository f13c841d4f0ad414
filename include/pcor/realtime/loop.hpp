#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcor/realtime/functors.hpp"
#include "pcor/realtime/rate_of_change.hpp"

namespace pcor {

/// The host of a sample loop at one rate: runs functors in the order of their dependencies, sample by sample.
///
/// All memory is taken while the loop is set up. `run` allocates nothing, throws nothing, takes no lock and
/// reads no global. What functors keep of earlier samples belongs to this loop alone, so 1 Hz and 25 Hz each
/// have their own loop.
///
///     loop.state()[Quantity::static_pressure] = 702.3;   // every recorded quantity of this sample
///     loop.run(time);
///     use(loop.state()[Quantity::corrected_static_pressure], loop.quality());
class Loop {
 public:
  /// A loop at `rate` samples in a second. A step of more than one and a half samples is a gap.
  explicit Loop(double rate) : longest_step_(1.5 / rate) {}

  /// A loop that runs `model` on the roles `recorded`: delta-p, corrected pressures, Mach number, humidity,
  /// ambient temperature, airspeed, and what LAMS says where its airspeed is recorded. Returns nothing where
  /// the model cannot be used; `error` says why.
  static std::optional<Loop> build(const Model& model, const std::vector<Quantity>& recorded, double rate,
                                   std::string* error, CorrectWith with = CorrectWith::model);

  /// Makes room for a variable that the library does not know, for functors of the user's own. Returns
  /// `Quantity::count` where the room is used up.
  Quantity add_variable(std::string name) {
    if (extra_names_.size() == extra_capacity) return Quantity::count;
    extra_names_.push_back(std::move(name));
    return extra_quantity(extra_names_.size() - 1);
  }

  /// Adds a functor. The order of adding does not matter.
  void add(std::unique_ptr<Functor> functor) { functors_.push_back(std::move(functor)); }

  /// Puts the functors in order. Returns false where two write one quantity, or where they wait for each
  /// other; `error` says which.
  bool order(std::string* error);

  /// The values of this sample: set what is recorded, run, read what is derived.
  State<double>& state() { return state_; }
  const State<double>& state() const { return state_; }

  /// The quality bits of the last sample.
  QualityFlags quality() const { return quality_; }

  /// The variables beyond the quantities of the library, by name; number i is at `extra_quantity(i)`.
  const std::vector<std::string>& extra_names() const { return extra_names_; }

  /// Forgets all earlier samples.
  void reset() noexcept { started_ = false; }

  /// Runs all functors on the sample at `time`, in seconds. The first sample, one after a gap, and one whose
  /// time does not advance find every functor reset.
  void run(double time) noexcept {
    quality_.clear();
    const double step = time - previous_time_;
    if (!started_ || !(step > 0.0 && step <= longest_step_)) {
      for (const auto& functor : functors_) functor->reset();
    }
    started_ = true;
    previous_time_ = time;
    state_[Quantity::time] = time;
    for (const auto& functor : functors_) functor->compute(state_, quality_);
  }

 private:
  std::string name_of(Quantity quantity) const {
    const std::size_t place = index(quantity);
    return place < quantity_count ? std::string(quantity_facts[place].name)
                                  : extra_names_[place - quantity_count];
  }

  std::vector<std::unique_ptr<Functor>> functors_;
  std::vector<std::string> extra_names_;
  State<double> state_;
  QualityFlags quality_;
  double longest_step_;
  double previous_time_ = 0.0;
  bool started_ = false;
};

inline bool Loop::order(std::string* error) {
  const auto contains = [](const std::vector<Quantity>& list, Quantity quantity) {
    return std::find(list.begin(), list.end(), quantity) != list.end();
  };
  std::vector<std::size_t> writer(state_capacity, functors_.size());
  for (std::size_t f = 0; f < functors_.size(); ++f) {
    for (const Quantity output : functors_[f]->outputs()) {
      if (writer[index(output)] != functors_.size()) {
        if (error != nullptr) *error = "two functors write '" + name_of(output) + "'";
        return false;
      }
      writer[index(output)] = f;
    }
  }
  std::vector<std::unique_ptr<Functor>> ordered;
  std::vector<bool> written(state_capacity, true);
  for (std::size_t q = 0; q < state_capacity; ++q) written[q] = writer[q] == functors_.size();
  while (ordered.size() < writer.size()) {
    bool advanced = false;
    for (auto& functor : functors_) {
      if (functor == nullptr) continue;
      const bool ready = std::all_of(functor->inputs().begin(), functor->inputs().end(), [&](Quantity input) {
        return written[index(input)] || contains(functor->outputs(), input);
      });
      if (!ready) continue;
      for (const Quantity output : functor->outputs()) written[index(output)] = true;
      ordered.push_back(std::move(functor));
      advanced = true;
    }
    if (!advanced) break;
  }
  for (const auto& functor : functors_) {
    if (functor == nullptr) continue;
    for (const Quantity input : functor->inputs()) {
      if (!written[index(input)] && error != nullptr) {
        *error = "functors wait for each other: '" + name_of(input) + "' is needed for '" +
                 name_of(functor->outputs().front()) + "' and the other way round";
      }
    }
    return false;
  }
  functors_ = std::move(ordered);
  return true;
}

inline std::optional<Loop> Loop::build(const Model& model, const std::vector<Quantity>& recorded, double rate,
                                       std::string* error, CorrectWith with) {
  std::optional<Chain> built = Chain::build(model, recorded, error);
  if (!built) return std::nullopt;
  const auto chain = std::make_shared<const Chain>(std::move(*built));
  if (with == CorrectWith::lams && !chain->has_lams()) {
    if (error != nullptr) *error = "correction with LAMS needs the role 'lams_airspeed'";
    return std::nullopt;
  }
  Loop loop(rate);
  for (const std::string& name : chain->extra_names()) loop.add_variable(name);
  if (chain->derives(Quantity::static_pressure_rate)) {
    loop.add(std::make_unique<RateOfChange>(Quantity::static_pressure, Quantity::static_pressure_rate));
  }
  if (chain->derives(Quantity::dynamic_pressure_rate)) {
    loop.add(std::make_unique<RateOfChange>(Quantity::dynamic_pressure, Quantity::dynamic_pressure_rate));
  }
  loop.add(std::make_unique<MeasuredQuantities>(chain));
  loop.add(std::make_unique<StaticDefect>(chain));
  loop.add(std::make_unique<CorrectedPressures>(chain, with));
  loop.add(std::make_unique<AirState>(chain));
  if (chain->has_lams()) {
    loop.add(std::make_unique<LamsStaticDefect>(chain));
    loop.add(std::make_unique<LamsAir>(chain));
  }
  if (!loop.order(error)) return std::nullopt;
  return loop;
}

}  // namespace pcor
