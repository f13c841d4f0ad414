#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <pcor/physics/constants.hpp>
#include <pcor/realtime/loop.hpp>

namespace pcor {

/// A name in capitals, as nimbus keeps those of its defaults file.
inline std::string in_capitals(std::string name) {
  for (char& letter : name)
    letter = letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 'a' + 'A') : letter;
  return name;
}

namespace detail {

template <class Host, class = void>
struct HasTime : std::false_type {};

template <class Host>
struct HasTime<Host, std::void_t<decltype(Host::time())>> : std::true_type {};

// Name in `names` that shares the longest prefix and suffix with `name`, case-insensitive; empty if they are
// less than half of it.
inline std::string nearest_name(const std::string& name, const std::vector<std::string>& names) {
  const std::string requested = in_capitals(name);
  const auto in_common = [&requested](const std::string& other) {
    const std::string found = in_capitals(other);
    const auto begin = std::mismatch(requested.begin(), requested.end(), found.begin(), found.end()).first;
    const auto end = std::mismatch(requested.rbegin(), requested.rend(), found.rbegin(), found.rend()).first;
    return (begin - requested.begin()) + (end - requested.rbegin());
  };
  const auto nearest = std::max_element(
      names.begin(), names.end(),
      [&in_common](const std::string& a, const std::string& b) { return in_common(a) < in_common(b); });
  const auto half = static_cast<std::ptrdiff_t>(name.size() / 2);
  return nearest == names.end() || in_common(*nearest) < half ? std::string() : *nearest;
}

inline bool is_in_formula(const std::string& name, const Model& model) {
  return std::any_of(model.effects.begin(), model.effects.end(), [&name](const ModelEffect& effect) {
    const auto formula = Formula::parse(effect.formula, effect.parameter_names);
    if (!effect.is_formula() || !formula) return false;
    const std::vector<std::string>& variables = formula->variables();
    return std::find(variables.begin(), variables.end(), name) != variables.end();
  });
}

}  // namespace detail

/// One pressure system in a host like NCAR nimbus: a table of derived variables, each with one output and a
/// callback `void compute(Entry*)` that has no context pointer and runs at a low and at a high rate.
///
/// One entry is the leader, for example PCOR. Its dependency line lists all inputs, in the order given to
/// `install`; its callback `compute` runs the loop of the current rate and puts delta-p (hPa). Every other
/// entry (PSXC, QCXC, MACHX, ATX, TASX, PCORFLAG ...) lists the leader in its dependency line, so that the
/// host runs it later; its callback `fetch` puts one further result of the same run.
///
///     using Fuselage = pcor::NimbusSystem<Host, struct FuselageTag>;
///     pcor::check_defaults(model, "PCOR", names, pcor::Overrides::some, &error);  // optional overrides,
///     pcor::read_defaults(model, "PCOR", find);                                   // by name
///     Fuselage::install(model, {"static_pressure", "dynamic_pressure", "recovery_temperature"}, 1, 25,
///     &error);
///     {"PCOR", {"PSFD", "QCF", "RTF1"}, Fuselage::compute},
///     {"PSXC", {"PCOR"}, Fuselage::fetch<Quantity::corrected_static_pressure>},
///     {"ATX",  {"PCOR"}, Fuselage::fetch<Quantity::ambient_temperature>},
///     {"PCORFLAG", {"PCOR"}, Fuselage::fetch_quality},
///
/// `Host` is written by the aircraft program:
///
///     struct Host {
///       using Entry = DERTBL;
///       static double get(Entry*, std::size_t input);   // this sample's input; NaN if missing
///       static void put(Entry*, double);                // the output of the sample `delay()` ago
///       static bool high_rate();                        // which of the two rates is being computed
///       static double time();                           // of this sample, s since the first record
///     };
///
/// The leader requests the time, once per sample. A host without a public function `time` without arguments
/// must call at every sample of a rate, without a gap; at a gap it must call `reset`. examples/nimbus is such
/// a host.
///
/// Units are those of the library except for temperatures: quantities in K are passed in degC, in both
/// directions. Variables of formulas are passed unchanged.
///
/// `System` is a tag type of the pressure system; it need not be defined. As the callbacks have no context,
/// each system keeps its two loops in static members of this template, separate from every other system; low
/// and high rate share no state, and each is reset at its gaps. A host calls the callbacks from one thread.
/// They do not allocate or throw.
template <class Host, class System>
class NimbusSystem {
 public:
  using Entry = typename Host::Entry;

  /// Sets `model` up for both rates (samples per second, the lower first), replacing any previous model.
  /// `inputs` are the names of roles, or of variables in the model's formulas, in the order of the leader's
  /// dependency line. If an `uncertainty` is given, entries may fetch those of the results. Returns false
  /// without changes if the model cannot be used, with the reason in `error`.
  static bool install(const Model& model, const std::vector<std::string>& inputs, double low_rate,
                      double high_rate, std::string* error, CorrectWith with = CorrectWith::model,
                      const ModelUncertainty& uncertainty = {}) {
    const auto fail = [error](std::string why) {
      if (error != nullptr) *error = std::move(why);
      return false;
    };
    if (!(low_rate < high_rate)) {
      return fail("the low rate is " + detail::text_of_number(low_rate) + " Hz, the high rate " +
                  detail::text_of_number(high_rate) + " Hz; give the lower one first");
    }
    std::vector<Quantity> roles;
    for (const std::string& name : inputs) {
      if (std::count(inputs.begin(), inputs.end(), name) > 1) return fail("two inputs are '" + name + "'");
      if (quantity_named(name) == Quantity::count && !detail::is_in_formula(name, model)) {
        std::vector<std::string> known;
        for (std::size_t i = 0; i < role_count; ++i) known.emplace_back(quantity_info[i].name);
        const std::string nearest = detail::nearest_name(name, known);
        return fail("the input '" + name + "' is neither a role nor a variable of the model's formulas" +
                    (nearest.empty() ? "" : "; the nearest role is '" + nearest + "'"));
      }
      const Quantity quantity = quantity_named(name);
      if (quantity != Quantity::count && is_role(quantity)) roles.push_back(quantity);
    }
    BindingError why;
    std::optional<Chain> bound_model = Chain::build(model, roles, &why);
    if (!bound_model) return fail(why.message());
    if (const std::string fault = fault_of(model); !fault.empty()) return fail(fault);
    if (bound_model->needs(Quantity::time) && !detail::HasTime<Host>::value) {
      return fail(
          "an effect of the model depends on the time since the first record; give the host a function "
          "time()");
    }
    const auto chain = std::make_shared<const Chain>(std::move(*bound_model));
    std::optional<Loop> low = Loop::build(chain, low_rate, error, with, uncertainty);
    std::optional<Loop> high = Loop::build(chain, high_rate, error, with, uncertainty);
    if (!low || !high) return false;
    const std::vector<std::string>& extras = low->extra_names();
    for (const std::string& extra : extras) {
      if (std::count(inputs.begin(), inputs.end(), extra) == 0) {
        return fail("a formula of the model needs the input '" + extra + "'");
      }
    }
    std::vector<Input> bound;
    for (const std::string& name : inputs) {
      Quantity quantity = quantity_named(name);
      if (quantity == Quantity::count) {
        const auto extra = std::find(extras.begin(), extras.end(), name);
        if (extra == extras.end())
          return fail("the input '" + name + "' is a variable of no formula that acts; remove it");
        quantity = extra_quantity(static_cast<std::size_t>(extra - extras.begin()));
      } else if (!is_role(quantity)) {
        return fail("the input '" + name + "' is " +
                    (quantity == Quantity::time ? "no dependency; give the host a function time()"
                                                : "derived, not recorded; remove it"));
      }
      bound.push_back({quantity, zero_of(quantity)});
    }
    inputs_ = std::move(bound);
    low_ = {std::move(low), low_rate};
    high_ = {std::move(high), high_rate};
    run_ = 0;
    turns_.fill({});
    return true;
  }

  /// Callback of the leader: runs the sample and puts delta-p of the model, hPa. NaN if no model is
  /// installed.
  static void compute(Entry* entry) {
    LoopAtRate& rate = current();
    if (!rate.loop) return Host::put(entry, missing<double>());
    State<double>& state = rate.loop->state();
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      state[inputs_[i].quantity] = Host::get(entry, i) + inputs_[i].zero;
    }
    rate.loop->run(time_of(rate));
    latest_ = &*rate.loop;
    ++run_;
    Host::put(entry, state[Quantity::static_defect]);
  }

  /// Callback of an entry that puts another result of the leader's run. NaN if the leader has not run since
  /// the first entry of this result was last put; permanently NaN if the entry, or another one of the same
  /// result, is called before the leader's first run, because its values would be those of the previous
  /// sample: its dependency line lacks the leader.
  template <Quantity quantity>
  static void fetch(Entry* entry) {
    Host::put(entry, has_turn(turns_[index(quantity)], entry) ? latest_->state()[quantity] - zero_of(quantity)
                                                              : missing<double>());
  }

  /// The callback of an entry that is the quality bits of the leader's run, as a number. NaN as of `fetch`.
  static void fetch_quality(Entry* entry) {
    Host::put(entry, has_turn(turns_.back(), entry) ? static_cast<double>(latest_->quality().bits())
                                                    : missing<double>());
  }

  /// Delay, in samples, of the values put at the current rate (`Loop::delay`): 0 for a model without effects
  /// of rates of change. The host shifts them back in its files, and obtains the last ones before a gap and
  /// at the end by further calls with missing inputs.
  static std::size_t delay() { return current().loop ? current().loop->delay() : 0; }

  /// Clears all earlier samples of both rates, as at the start of a flight.
  static void reset() {
    for (LoopAtRate* rate : {&low_, &high_}) {
      if (rate->loop) rate->loop->reset();
      rate->samples = 0;
    }
    for (Turn& turn : turns_) {
      if (turn.run != never) turn = {run_, nullptr};
    }
  }

 private:
  struct Input {
    Quantity quantity;
    double zero;
  };

  struct LoopAtRate {
    std::optional<Loop> loop{};
    double samples_per_second = 0.0;
    std::size_t samples = 0;
  };

  // Last run of which a result was put, and the first entry that did; no entry after that one is called
  // again.
  struct Turn {
    std::size_t run = 0;
    const Entry* first = nullptr;
  };

  static constexpr std::size_t never = std::numeric_limits<std::size_t>::max();

  // Zero of the host's unit in the unit of the library. An uncertainty in K is a difference.
  static constexpr double zero_of(Quantity quantity) {
    if (quantity == Quantity::ambient_temperature_uncertainty) return 0.0;
    return index(quantity) < quantity_count && info_of(quantity).unit == "K" ? constants::ice_point : 0.0;
  }

  static LoopAtRate& current() { return Host::high_rate() ? high_ : low_; }

  static double time_of(LoopAtRate& rate) {
    if constexpr (detail::HasTime<Host>::value) {
      return Host::time();
    } else {
      return static_cast<double>(rate.samples++) / rate.samples_per_second;
    }
  }

  // True if the entry is called after a run of the leader that it has not put yet. Entries of one result
  // share this state: when the first of them is called again, the host is at another sample.
  static bool has_turn(Turn& turn, const Entry* entry) {
    if (turn.run < run_) {
      turn = {run_, entry};
      return true;
    }
    if (run_ == 0) turn = {never, nullptr};
    if (turn.first == entry) turn.first = nullptr;
    return turn.first != nullptr;
  }

  static inline std::vector<Input> inputs_;
  static inline LoopAtRate low_;
  static inline LoopAtRate high_;
  static inline const Loop* latest_ = nullptr;
  static inline std::size_t run_ = 0;
  // One per quantity, and one for the quality bits.
  static inline std::array<Turn, state_capacity + 1> turns_{};
};

/// Name of coefficient number `number` of `effect` in a defaults file: `PCOR.static-alpha.a1` for the
/// `prefix` PCOR. The prefix distinguishes the systems of one aircraft.
inline std::string default_key(const std::string& prefix, const ModelEffect& effect, std::size_t number) {
  std::string name = std::to_string(number);
  if (number < effect.parameter_names.size()) {
    name = effect.parameter_names[number];
  } else if (const EffectInfo* const info = effect_named(effect.id);
             info != nullptr && number < info->parameter_count()) {
    name = info->parameters[number].name;
  }
  return prefix + "." + effect.id + "." + name;
}

/// The names of all coefficients of `model` in a defaults file.
inline std::vector<std::string> default_keys(const Model& model, const std::string& prefix) {
  std::vector<std::string> keys;
  for (const ModelEffect& effect : model.effects) {
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) keys.push_back(default_key(prefix, effect, i));
  }
  return keys;
}

/// Replaces the coefficients of `model` that a defaults file names, in original or upper case, and returns
/// their number. `find(key)`, with a `const char*`, gives a pointer to the value (`const float*` or `const
/// double*`), or nullptr if the file does not have it. A `float` holds seven digits.
template <class Find>
std::size_t read_defaults(Model& model, const std::string& prefix, Find find) {
  std::size_t replaced = 0;
  for (ModelEffect& effect : model.effects) {
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
      const std::string key = default_key(prefix, effect, i);
      const auto* value = find(key.c_str());
      if (value == nullptr) value = find(in_capitals(key).c_str());
      if (value == nullptr) continue;
      effect.parameters[i] = static_cast<double>(*value);
      ++replaced;
    }
  }
  return replaced;
}

namespace detail {

// True for the two spellings of a coefficient that `read_defaults` requests.
inline bool is_read_as(const std::string& coefficient, const std::string& key) {
  return key == coefficient || key == in_capitals(coefficient);
}

}  // namespace detail

/// Unused overrides: names among `keys` of a defaults file that begin with `prefix`, case-insensitive, and a
/// point but are not a coefficient of `model`, in original or upper case. A host should report them and stop.
inline std::vector<std::string> unread_defaults(const Model& model, const std::string& prefix,
                                                const std::vector<std::string>& keys) {
  const std::vector<std::string> known = default_keys(model, prefix);
  std::vector<std::string> unread;
  for (const std::string& key : keys) {
    const bool is_ours = in_capitals(key).rfind(in_capitals(prefix) + ".", 0) == 0;
    const bool is_read = std::any_of(known.begin(), known.end(), [&key](const std::string& coefficient) {
      return detail::is_read_as(coefficient, key);
    });
    if (is_ours && !is_read) unread.push_back(key);
  }
  return unread;
}

/// Whether a defaults file may leave coefficients of a model to the model (`some`).
enum class Overrides { some, all };

/// False if `keys` of a defaults file have `unread_defaults`, or if `all` coefficients of `model` are
/// expected and one is missing. `error` then names it, and the nearest name.
inline bool check_defaults(const Model& model, const std::string& prefix,
                           const std::vector<std::string>& keys, Overrides expected, std::string* error) {
  const std::vector<std::string> coefficients = default_keys(model, prefix);
  const auto fail = [error](const std::string& why, const std::string& name,
                            const std::vector<std::string>& others) {
    const std::string nearest = detail::nearest_name(name, others);
    if (error != nullptr) *error = why + (nearest.empty() ? "" : "; the nearest is '" + nearest + "'");
    return false;
  };
  const std::vector<std::string> unread = unread_defaults(model, prefix, keys);
  if (!unread.empty()) {
    return fail("the defaults file has '" + unread.front() + "', which no coefficient of the model reads",
                unread.front(), coefficients);
  }
  if (expected == Overrides::some) return true;
  for (const std::string& coefficient : coefficients) {
    const bool is_there = std::any_of(keys.begin(), keys.end(), [&coefficient](const std::string& key) {
      return detail::is_read_as(coefficient, key);
    });
    if (!is_there)
      return fail("the defaults file lacks the coefficient '" + coefficient + "'", coefficient, keys);
  }
  return true;
}

}  // namespace pcor
