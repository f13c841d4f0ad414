#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pcor/realtime/bound_model.hpp>

namespace pcor {

/// Reason for which a model cannot be used on the recorded quantities.
struct BindingError {
  enum class Code : std::uint8_t {
    unknown_effect,
    unknown_quantity,
    parameter_count,
    formula,              ///< it cannot be read, or uses too many variables
    role_missing,         ///< `quantity` is a role without a variable
    circular_dependency,  ///< `quantity` is known only after delta-p, or after the effect
  };

  Code code = Code::unknown_effect;
  Quantity quantity = Quantity::count;  ///< missing quantity
  std::string who{};                    ///< e.g. "effect 'qcf-lag'"; empty if the message names it
  std::string what{};                   ///< what is wrong and what to do, e.g. "needs the role ..."

  /// Both in one line.
  std::string message() const { return who.empty() ? what : who + " " + what; }
};

/// End of a message, after "needs the role ..., which".
inline constexpr std::string_view not_recorded =
    " is not among the recorded quantities; add it, in a model file as a variable in [variables]";

/// Checks a model against the recorded quantities, and binds it.
class ModelBinder {
 public:
  /// `model` bound to the roles `recorded`, or why it cannot be.
  static std::optional<BoundModel> bind(const Model& model, const std::vector<Quantity>& recorded,
                                        BindingError& error) {
    ModelBinder binder(BoundModel{}, error);
    if (!binder.add_model(model, recorded)) return std::nullopt;
    return binder.take();
  }

  /// `bound` with one more effect at the end of the model, or why it cannot be had.
  static std::optional<BoundModel> with_effect(BoundModel bound, const ModelEffect& effect,
                                               BindingError& error) {
    ModelBinder binder(std::move(bound), error);
    if (!binder.add(effect)) return std::nullopt;
    return binder.take();
  }

 private:
  using Code = BindingError::Code;
  using Term = BoundModel::Term;

  ModelBinder(BoundModel bound, BindingError& error) : bound_(std::move(bound)), error_(error) {}

  BoundModel take() {
    bound_.inputs_.clear();
    for (std::size_t i = 0; i < state_capacity; ++i) {
      if (bound_.recorded_[i]) bound_.inputs_.push_back(static_cast<Quantity>(i));
    }
    if (describes_flaps_) bound_.watches_flaps_ = false;
    return std::move(bound_);
  }

  bool add_model(const Model& model, const std::vector<Quantity>& recorded) {
    for (const Quantity quantity : recorded) {
      if (quantity == Quantity::count || index(quantity) >= state_capacity) {
        return fail(Code::unknown_quantity, "",
                    "number " + std::to_string(index(quantity)) +
                        " among the recorded quantities is not a quantity; quantity_named returns "
                        "Quantity::count for an unknown name: correct the name");
      }
      if (index(quantity) >= index(Quantity::port_static_pressure) && index(quantity) < quantity_count) {
        return fail(Code::unknown_quantity, "",
                    quote(info_of(quantity).name) +
                        " among the recorded quantities is a result of the chain; remove it");
      }
      bound_.recorded_.set(index(quantity));
    }
    bound_.lams_ = model.lams;
    bound_.recovery_ = model.recovery;
    bound_.attack_radome_ = model.attack_radome;
    bound_.sideslip_radome_ = model.sideslip_radome;
    bound_.policy_ = model.policy;
    bound_.moist_ = model.moist;
    for (const Quantity pressure : {Quantity::static_pressure, Quantity::dynamic_pressure}) {
      if (!require(pressure, "the chain")) return false;
    }
    for (const ModelEffect& effect : model.effects) {
      if (!add(effect)) return false;
    }
    for (const EffectLocation location : model.additions) add_addition(location);
    for (const DomainRange& range : model.domain) {
      if (!add_range(range)) return false;
    }
    bound_.watches_flaps_ = bound_.recorded(Quantity::flaps) && changes_results_;
    return !bound_.has_lams() || require_lams();
  }

  bool fail(Code code, std::string who, std::string what, Quantity quantity = Quantity::count) {
    error_ = {code, quantity, std::move(who), std::move(what)};
    return false;
  }

  static std::string quote(std::string_view name) { return "'" + std::string(name) + "'"; }

  bool add(const ModelEffect& effect) {
    if (effect.is_surface()) return add_surface(effect);
    return effect.is_formula() ? add_formula(effect) : add_catalogued(effect);
  }

  bool add_catalogued(const ModelEffect& effect) {
    const std::string who = "effect " + quote(effect.id);
    const EffectInfo* const info = effect_named(effect.id);
    if (info == nullptr) {
      return fail(Code::unknown_effect, "",
                  "there is no " + who + " in the catalogue; correct the id, or give a formula");
    }
    if (!require_count(effect, info->parameter_count())) return false;
    if (bound_.is_within_reach(info->location)) {
      if (!require_location(info->location, who)) return false;
      for (std::size_t i = 0; i < info->need_count(); ++i) {
        if (is_at_hand(info->needs[i], info->location)) continue;
        if (!require(info->needs[i], who)) return false;
      }
    }
    Term term;
    term.effect = index_of(*info);
    term.location = info->location;
    term.scaling = effect.scaling;
    add_effect(term, effect);
    return true;
  }

  bool add_formula(const ModelEffect& effect) {
    FormulaError formula_error;
    std::optional<Formula> formula = Formula::parse(effect.formula, effect.parameter_names, &formula_error);
    const std::string who = "formula of effect " + quote(effect.id);
    if (!formula) return fail(Code::formula, who + ":", formula_error.message);
    if (!require_count(effect, effect.parameter_names.size())) return false;
    if (formula->variables().size() > BoundModel::formula_variable_capacity) {
      return fail(Code::formula, who,
                  "uses more than " + std::to_string(BoundModel::formula_variable_capacity) + " variables");
    }
    Term term;
    term.formula = bound_.formulas_.size();
    term.location = effect.location;
    BoundModel::BoundFormula bound{std::move(*formula), {}};
    if (bound_.is_within_reach(effect.location) && !bind_variables(bound, effect.location, "the " + who))
      return false;
    bound_.formulas_.push_back(std::move(bound));
    add_effect(term, effect);
    return true;
  }

  // Outside its envelope a surface is flat, and the sample is flagged as outside the domain.
  bool add_surface(const ModelEffect& effect) {
    const std::string who = "effect " + quote(effect.id);
    if (!require_count(effect, effect.surface->parameter_count())) return false;
    Term term;
    term.effect = Term::is_surface;
    term.formula = bound_.surfaces_.size();
    for (const SurfaceAxis& axis : effect.surface->axes) {
      if (!axis.is_valid()) return fail(Code::formula, who, "has an axis without extent");
      if (!require(axis.quantity, who)) return false;
      bound_.domain_.push_back({axis.quantity, axis.lower, axis.upper, true});
    }
    bound_.surfaces_.push_back(*effect.surface);
    add_effect(term, effect);
    return true;
  }

  bool bind_variables(BoundModel::BoundFormula& bound, EffectLocation location, const std::string& who) {
    if (!require_location(location, who)) return false;
    for (const std::string& name : bound.formula.variables()) {
      Quantity quantity = quantity_named(name);
      if (quantity == Quantity::count && !find_extra(name, quantity)) {
        return fail(Code::formula, "",
                    "the formulas of the model use more than " + std::to_string(extra_capacity) +
                        " further variables");
      }
      if (location == EffectLocation::attack_ratio && quantity == Quantity::attack &&
          !bound_.recorded(quantity)) {
        return fail(Code::circular_dependency, who,
                    "needs 'attack', which is derived from the ratio that it corrects; use 'attack_ratio'",
                    quantity);
      }
      if (!is_at_hand(quantity, location) && !require(quantity, who)) return false;
      bound.variables.push_back(quantity);
    }
    return true;
  }

  bool require_count(const ModelEffect& effect, std::size_t count) {
    return effect.parameters.size() == count ||
           fail(Code::parameter_count, "effect " + quote(effect.id),
                "takes " + std::to_string(count) + " parameter(s), not " +
                    std::to_string(effect.parameters.size()));
  }

  // Checks that the quantity corrected by an effect is computed.
  bool require_location(EffectLocation location, const std::string& who) {
    if (location == EffectLocation::radome) return require(Quantity::radome_dynamic_pressure, who);
    if (location == EffectLocation::attack_ratio) return require(Quantity::attack_ratio, who);
    if (location == EffectLocation::ambient_temperature && !bound_.has_temperature()) {
      return fail(
          Code::role_missing, who,
          "needs the role 'recovery_temperature' or 'ambient_temperature', which" + std::string(not_recorded),
          Quantity::recovery_temperature);
    }
    return true;
  }

  // Calibration effects of the ambient temperature use its derived or recorded value.
  static bool is_at_hand(Quantity quantity, EffectLocation location) {
    return location == EffectLocation::ambient_temperature && quantity == Quantity::ambient_temperature;
  }

  void add_effect(Term term, const ModelEffect& effect) {
    term.first_parameter = bound_.parameters_.size();
    term.parameter_count = effect.parameters.size();
    bound_.parameters_.insert(bound_.parameters_.end(), effect.parameters.begin(), effect.parameters.end());
    bound_.effects_.push_back(term);
    if (!is_neutral(term, effect)) {
      changes_results_ = true;
      if (reads_flaps(term)) describes_flaps_ = true;
    }
    if (bound_.is_within_reach(term.location)) add_term(term);
  }

  static bool is_neutral(const Term& term, const ModelEffect& effect) {
    if (term.effect >= catalogue_size) return false;
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
      const auto& parameter = effect_info[term.effect].parameters[i];
      if (!parameter.shape && effect.parameters[i] != parameter.neutral) return false;
    }
    return true;
  }

  bool reads_flaps(const Term& term) const {
    const auto is_among = [](const auto& quantities) {
      return std::find(quantities.begin(), quantities.end(), Quantity::flaps) != quantities.end();
    };
    if (term.effect < catalogue_size) return is_among(effect_info[term.effect].needs);
    if (term.effect == Term::is_formula) return is_among(bound_.formulas_[term.formula].variables);
    const auto& axes = bound_.surfaces_[term.formula].axes;
    return axes[0].quantity == Quantity::flaps || axes[1].quantity == Quantity::flaps;
  }

  // Additional amounts have no inputs; at a location that the model does not use, they have no effect.
  void add_addition(EffectLocation location) {
    Term term;
    term.effect = Term::is_addition;
    term.location = location;
    term.first_parameter = bound_.parameters_.size();
    bound_.parameters_.push_back(0.0);
    add_term(term);
  }

  // Inserted after the other terms of its location.
  void add_term(const Term& term) {
    const auto end = static_cast<std::ptrdiff_t>(bound_.begin_of(term.location, 1));
    bound_.terms_.insert(bound_.terms_.begin() + end, term);
    const auto location = static_cast<std::size_t>(term.location);
    for (std::size_t next = location + 1; next <= location_count; ++next) ++bound_.where_begin_[next];
    bound_.acting_.set(location);
  }

  // Element of a further variable, added if the name is new. False if the capacity is exhausted.
  bool find_extra(const std::string& name, Quantity& quantity) {
    std::vector<std::string>& names = bound_.extra_names_;
    const auto found = std::find(names.begin(), names.end(), name);
    const auto number = static_cast<std::size_t>(found - names.begin());
    if (number == extra_capacity) return false;
    quantity = extra_quantity(number);
    if (found == names.end()) {
      names.push_back(name);
      bound_.recorded_.set(index(quantity));
    }
    return true;
  }

  bool add_range(const DomainRange& range) {
    const Quantity quantity = quantity_named(range.quantity);
    if (quantity == Quantity::count)
      return fail(Code::unknown_quantity, "the domain of the model:",
                  "there is no quantity " + quote(range.quantity) + "; correct the name");
    if (!require(quantity, "the domain of the model")) return false;
    bound_.domain_.push_back({quantity, range.lower, range.upper, false});
    if (quantity == Quantity::flaps) describes_flaps_ = true;
    return true;
  }

  bool require_lams() {
    if (!require(Quantity::attack, "LAMS, for the angle between its beam and the wind,")) return false;
    if (bound_.recorded(Quantity::sideslip) || bound_.sideslip_radome_.is_calibrated()) {
      if (!require(Quantity::sideslip, "LAMS")) return false;
    }
    const Quantity thermometer = bound_.lams_.approach == LamsApproach::with_temperature
                                     ? Quantity::ambient_temperature
                                     : Quantity::recovery_temperature;
    return require(thermometer, "LAMS");
  }

  // Marks a quantity and all that it is derived from as needed.
  bool require(Quantity quantity, const std::string& who) {
    bound_.needed_.set(index(quantity));
    if (bound_.recorded(quantity)) return true;
    switch (quantity) {
      case Quantity::time:
      case Quantity::dynamic_ratio:
      case Quantity::mach:
      case Quantity::static_pressure_rate:
      case Quantity::dynamic_pressure_rate:
        return true;
      case Quantity::recovery_temperature_rate:
        return require(Quantity::recovery_temperature, who);
      case Quantity::ambient_temperature_rate:
        return require(Quantity::ambient_temperature, who);
      case Quantity::airspeed_rate:
        return require(bound_.has_temperature() && !bound_.derives_temperature()
                           ? Quantity::ambient_temperature
                           : Quantity::recovery_temperature,
                       who);
      case Quantity::wetness:
        return require(Quantity::liquid_water, who);
      case Quantity::vapor_pressure:
        return require_vapor_pressure(who);
      case Quantity::attack_ratio:
        return require(Quantity::attack_differential_pressure, who) &&
               require(Quantity::radome_dynamic_pressure, who);
      case Quantity::sideslip_ratio:
        return require(Quantity::sideslip_differential_pressure, who) &&
               require(Quantity::radome_dynamic_pressure, who);
      case Quantity::attack:
        return require_angle(bound_.attack_radome_, quantity, Quantity::attack_ratio, who);
      case Quantity::sideslip:
        return require_angle(bound_.sideslip_radome_, quantity, Quantity::sideslip_ratio, who);
      default:
        return fail_missing(quantity, who);
    }
  }

  bool require_vapor_pressure(const std::string& who) {
    for (const Quantity mirror : {Quantity::dew_point, Quantity::frost_point}) {
      if (bound_.recorded(mirror)) return require(mirror, who);
    }
    return fail_missing(Quantity::vapor_pressure, who);
  }

  bool require_angle(const RadomeCalibration& radome, Quantity angle, Quantity ratio,
                     const std::string& who) {
    if (!radome.is_calibrated()) {
      const std::string name(info_of(angle).name);
      return fail(Code::role_missing, who,
                  "needs the role '" + name + "', which" + std::string(not_recorded) + ", or give [radome] " +
                      name + " = [offset, slope] to derive it from the radome pressures",
                  angle);
    }
    if (radome.needs_mach() && !require(Quantity::mach, who)) return false;
    return require(ratio, who);
  }

  bool fail_missing(Quantity quantity, const std::string& who) {
    const std::string name = quote(info_of(quantity).name);
    if (!is_role(quantity))
      return fail(Code::circular_dependency, who,
                  "needs " + name + ", which is known only after delta-p" +
                      (quantity == Quantity::corrected_mach ? "; use 'mach', of the measured pressures" : ""),
                  quantity);
    return fail(Code::role_missing, who, "needs the role " + name + ", which" + std::string(not_recorded),
                quantity);
  }

  BoundModel bound_;
  BindingError& error_;
  bool changes_results_ = false;
  bool describes_flaps_ = false;
};

}  // namespace pcor
