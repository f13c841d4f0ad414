#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <string>
#include <vector>

#include <pcor/effects/catalogue.hpp>
#include <pcor/model/formula.hpp>
#include <pcor/model/model.hpp>
#include <pcor/model/state.hpp>

namespace pcor {

/// Model bound to recorded quantities: effects by location with their inputs, and required, recorded and
/// derived quantities. Created by `ModelBinder`.
class BoundModel {
 public:
  /// The coefficients of all effects, one after another in the order of the model; after them, zero, what is
  /// added at each of the model's `additions`.
  const std::vector<double>& parameters() const { return parameters_; }

  /// Further variables of formulas, by name. Number i belongs at `extra_quantity(i)` of a state.
  const std::vector<std::string>& extra_names() const { return extra_names_; }

  /// Recorded quantities, including those of formulas.
  const std::vector<Quantity>& inputs() const { return inputs_; }

  /// True if the quantity is recorded.
  bool recorded(Quantity quantity) const { return recorded_[index(quantity)]; }

  /// True if some stage needs the quantity.
  bool needs(Quantity quantity) const { return needed_[index(quantity)]; }

  /// True if the chain computes the quantity from others because it is not recorded.
  bool derives(Quantity quantity) const { return needs(quantity) && !recorded(quantity); }

  /// True if an effect acts at the location.
  bool acts(EffectLocation location) const { return acting_[static_cast<std::size_t>(location)]; }

  /// Inputs of the effects at a location; at the static ports also those of the domain of the model.
  std::vector<Quantity> read_at(EffectLocation location) const {
    std::vector<Quantity> read;
    for (std::size_t i = begin_of(location); i < begin_of(location, 1); ++i) {
      const Term& term = terms_[i];
      if (term.effect < catalogue_size) {
        const EffectInfo& info = effect_info[term.effect];
        read.insert(read.end(), info.needs.begin(), info.needs.begin() + info.need_count());
        if (term.scaling.static_pressure != 0) read.push_back(Quantity::static_pressure);
        if (term.scaling.dynamic_pressure != 0) read.push_back(Quantity::dynamic_pressure);
      } else if (term.effect == Term::is_formula) {
        const std::vector<Quantity>& variables = formulas_[term.formula].variables;
        read.insert(read.end(), variables.begin(), variables.end());
      } else if (term.effect == Term::is_surface) {
        const Surface& surface = surfaces_[term.formula];
        read.insert(read.end(),
                    {surface.axes[0].quantity, surface.axes[1].quantity, Quantity::dynamic_pressure});
      }
    }
    if (location == EffectLocation::static_defect) {
      for (const Range& range : domain_) read.push_back(range.quantity);
      if (watches_flaps_) read.push_back(Quantity::flaps);
    }
    return read;
  }

  bool has_temperature() const {
    return recorded(Quantity::recovery_temperature) || recorded(Quantity::ambient_temperature);
  }

  /// True if the ambient temperature is derived from the recovery temperature; a recorded one has priority.
  bool derives_temperature() const {
    return recorded(Quantity::recovery_temperature) && !recorded(Quantity::ambient_temperature);
  }

  /// True if a recorded ambient temperature is calibrated, in place, by `Chain::correct_inputs`.
  bool calibrates_recorded_temperature() const {
    return acts(EffectLocation::ambient_temperature) && recorded(Quantity::ambient_temperature);
  }

  /// True if water vapour changes the gas constants: with moist constants, or by an effect.
  bool counts_vapor() const { return moist_ || acts(EffectLocation::humidity); }

  bool has_lams() const { return recorded(Quantity::lams_airspeed); }

  /// Number of effects of the model; location of each, index of its first coefficient in `parameters`, and
  /// number of its coefficients.
  std::size_t effect_count() const { return effects_.size(); }
  EffectLocation location_of(std::size_t effect) const { return effects_[effect].location; }
  std::size_t first_parameter_of(std::size_t effect) const { return effects_[effect].first_parameter; }
  std::size_t parameter_count_of(std::size_t effect) const { return effects_[effect].parameter_count; }

  /// Time constant, s, of a quantity computed from earlier samples (`EffectInfo::memory`): the coefficient of
  /// the effect; without such an effect, as for a formula, its neutral value.
  double time_of(Quantity quantity) const {
    for (const Term& term : effects_) {
      if (term.effect >= catalogue_size) continue;
      const Memory& memory = effect_info[term.effect].memory;
      if (memory.of == quantity) return parameters_[term.first_parameter + memory.parameter];
    }
    for (const EffectInfo& info : effect_info) {
      if (info.memory.of == quantity) return info.parameters[info.memory.parameter].neutral;
    }
    return 0.0;
  }

  /// True if the effect is linear in this coefficient, and zero if all such coefficients are zero.
  bool is_linear(std::size_t effect, std::size_t parameter) const {
    const std::size_t entry = effects_[effect].effect;
    if (entry == Term::is_surface) return true;
    return entry < catalogue_size && !effect_info[entry].parameters[parameter].shape;
  }

  /// Coefficients of an effect at which its value is its derivative with respect to a coefficient in which it
  /// is linear: 1 for this one, 0 for others in which it is linear. Allocates: for construction, not for the
  /// sample loop.
  /// @param effect below `effect_count` @param parameter below `parameter_count_of` the effect
  /// @param parameters coefficients of all effects, in the order of `parameters()`
  std::vector<double> unit_coefficients(std::size_t effect, std::size_t parameter,
                                        const double* parameters) const {
    const double* const first = parameters + first_parameter_of(effect);
    std::vector<double> coefficients(first, first + parameter_count_of(effect));
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
      if (is_linear(effect, i)) coefficients[i] = i == parameter ? 1.0 : 0.0;
    }
    return coefficients;
  }

  /// Surface of effect number `effect` of the model; null for other effects.
  const Surface* surface_of(std::size_t effect) const {
    const Term& term = effects_[effect];
    return term.effect == Term::is_surface ? &surfaces_[term.formula] : nullptr;
  }

  /// Value of effect number `effect` of the model for a state after `Chain::correct_inputs`, in the unit of
  /// its location. Zero for an effect on the laser's beam if there is no laser. @param coefficients the
  /// coefficients of this effect only
  template <class S, class P>
  Promoted<S, P> effect_value(std::size_t effect, const State<S>& state, const P* coefficients) const {
    const Term& term = effects_[effect];
    return is_within_reach(term.location) ? value(term, state, coefficients) : Promoted<S, P>(0.0);
  }

 protected:
  // Sum of the effects at a location.
  template <class R, class S, class P>
  R sum(EffectLocation location, const State<S>& state, const P* parameters) const {
    return acts(location) ? sum_of_terms<R>(location, state, parameters) : R(0.0);
  }

  // Additional amount at a location.
  template <class R, class P>
  R amount_added_at(EffectLocation location, const P* parameters) const {
    R total(0.0);
    for (std::size_t i = begin_of(location); i < begin_of(location, 1); ++i) {
      if (terms_[i].effect == Term::is_addition) total = total + R(parameters[terms_[i].first_parameter]);
    }
    return total;
  }

  LamsMounting lams_;
  RecoveryFactor recovery_;
  RadomeCalibration attack_radome_;
  RadomeCalibration sideslip_radome_;
  Policy policy_;
  bool moist_ = true;

  struct Range {
    Quantity quantity;
    double lower;
    double upper;
    bool is_of_surface;  // its envelope, not the domain of the law
  };
  std::vector<Range> domain_;
  bool watches_flaps_ = false;  // recorded, and in no effect and not in the domain: outside it if extended

 private:
  friend class ModelBinder;

  // Term at a location: an effect of the catalogue, a formula or a surface with an index, or an amount that
  // is a parameter.
  struct Term {
    static constexpr std::size_t is_formula = catalogue_size;
    static constexpr std::size_t is_addition = catalogue_size + 1;
    static constexpr std::size_t is_surface = catalogue_size + 2;

    std::size_t effect = is_formula;
    std::size_t formula = 0;
    std::size_t first_parameter = 0;
    std::size_t parameter_count = 0;
    EffectLocation location = EffectLocation::static_defect;
    Scaling scaling{};
  };

  static constexpr std::size_t formula_variable_capacity = 12;

  struct BoundFormula {
    Formula formula;
    std::vector<Quantity> variables;
  };

  std::size_t begin_of(EffectLocation location, std::size_t next = 0) const {
    return where_begin_[static_cast<std::size_t>(location) + next];
  }

  // Without a laser nothing acts on its beam.
  bool is_within_reach(EffectLocation location) const {
    const bool on_beam = location == EffectLocation::beam_elevation ||
                         location == EffectLocation::beam_azimuth || location == EffectLocation::beam_speed;
    return !on_beam || has_lams();
  }

  template <class R, class S, class P>
  R sum_of_terms(EffectLocation location, const State<S>& state, const P* parameters) const {
    R total(0.0);
    const Term* const end = terms_.data() + begin_of(location, 1);
    for (const Term* term = terms_.data() + begin_of(location); term != end; ++term) {
      total = total + value(*term, state, parameters + term->first_parameter);
    }
    return finite_or_missing(total);
  }

  template <class S, class P>
  Promoted<S, P> value(const Term& term, const State<S>& state, const P* coefficients) const {
    if (term.effect < catalogue_size) {
      const Promoted<S, P> value = effect_functions<S, P>[term.effect](state, coefficients);
      return term.scaling.is_none() ? value : scaled(value, term.scaling, state);
    }
    if (term.effect == Term::is_addition) return Promoted<S, P>(*coefficients);
    if (term.effect == Term::is_surface) {
      const Surface& surface = surfaces_[term.formula];
      return surface.value(state[surface.axes[0].quantity], state[surface.axes[1].quantity],
                           state[Quantity::dynamic_pressure], coefficients);
    }
    const BoundFormula& bound = formulas_[term.formula];
    std::array<S, formula_variable_capacity> variables;
    for (std::size_t i = 0; i < bound.variables.size(); ++i) variables[i] = state[bound.variables[i]];
    return bound.formula.value(variables.data(), coefficients);
  }

  template <class R, class S>
  static R scaled(const R& value, const Scaling& scaling, const State<S>& state) {
    return value * R(factor(scaling, state[Quantity::static_pressure], state[Quantity::dynamic_pressure]));
  }

  std::vector<Term> effects_;  // order of the model
  std::vector<Term> terms_;    // terms in the order of locations
  std::array<std::size_t, location_count + 1> where_begin_{};
  std::bitset<location_count> acting_;  // true for each location with a term
  std::vector<BoundFormula> formulas_;
  std::vector<Surface> surfaces_;
  std::vector<double> parameters_;
  std::vector<std::string> extra_names_;
  std::vector<Quantity> inputs_;
  std::bitset<state_capacity> recorded_;
  std::bitset<state_capacity> needed_;
};

}  // namespace pcor
