#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <pcor/effects/catalogue.hpp>
#include <pcor/model/formula.hpp>
#include <pcor/model/model.hpp>
#include <pcor/model/quality.hpp>
#include <pcor/model/state.hpp>
#include <pcor/physics/air_data.hpp>
#include <pcor/physics/humidity.hpp>
#include <pcor/physics/lams.hpp>

namespace pcor {

/// Inverts the measurement, stage by stage, from recorded values to free air, for one model.
///
///     measure -> static_defect -> correct -> air -> LAMS temperature and dynamic pressure
///             -> lams_static_defect
///
/// Every stage reads and writes a `State`. It is a template over the scalars of the state, `S`, and of the
/// parameters, `P`, so that the same lines serve the real-time loop (both `double`), batches (`S` a vector
/// pack) and fits (`P` a dual number). Where effects act before the static ports, `S` must be the promoted
/// type. After `build` a chain allocates nothing, throws nothing, and holds nothing of a sample.
class Chain {
 public:
  /// Prepares `model` for states in which the roles `recorded` are known. Returns nothing where the model
  /// cannot be used; `error` then says why and what to do, in one line.
  static std::optional<Chain> build(const Model& model, const std::vector<Quantity>& recorded,
                                    std::string* error);

  /// The coefficients of all effects, one after another in the order of the model.
  const std::vector<double>& parameters() const { return parameters_; }

  /// The variables that formulas use beyond the quantities of the library, by name. Number i belongs at
  /// `extra_quantity(i)` of a state.
  const std::vector<std::string>& extra_names() const { return extra_names_; }

  /// The recorded quantities, those of formulas included.
  const std::vector<Quantity>& inputs() const { return inputs_; }

  /// True where the quantity is recorded.
  bool recorded(Quantity quantity) const { return recorded_[index(quantity)]; }

  /// True where some stage needs the quantity.
  bool needs(Quantity quantity) const { return needed_[index(quantity)]; }

  /// True where the chain computes the quantity from others because it is not recorded.
  bool derives(Quantity quantity) const { return needs(quantity) && !recorded(quantity); }

  /// True where some effect acts at the place.
  bool acts(Where where) const { return begin_of(where) != begin_of(where, 1); }

  bool has_temperature() const {
    return recorded(Quantity::recovery_temperature) || recorded(Quantity::ambient_temperature);
  }

  /// True where the ambient temperature is found from the recovery temperature; a recorded one goes before
  /// it.
  bool derives_temperature() const {
    return recorded(Quantity::recovery_temperature) && !recorded(Quantity::ambient_temperature);
  }

  /// True where a recorded ambient temperature is calibrated, which `measure` does in its place.
  bool calibrates_recorded_temperature() const {
    return acts(Where::ambient_temperature) && recorded(Quantity::ambient_temperature);
  }

  bool has_lams() const { return recorded(Quantity::lams_airspeed); }
  bool needs_rates() const {
    return std::any_of(rates.begin(), rates.end(), [this](const Rate& each) { return needs(each.rate); });
  }

  /// The quantities in which the laws stand, the pressures at the ports, and the calibration of a recorded
  /// ambient temperature. A recorded value that is infinite is missing from here on.
  template <class S, class P, class Flags>
  void measure(State<S>& state, const P* parameters, Flags& flags) const {
    for (const Quantity input : inputs_) state[input] = finite_or_missing(state[input]);
    const S p = state[Quantity::static_pressure];
    const S q = state[Quantity::dynamic_pressure];
    flags.set(is_missing(p), Quality::static_pressure_missing);
    flags.set(is_missing(q), Quality::dynamic_pressure_missing);
    flags.set(p <= S(0.0), Quality::impossible_static_pressure);
    flags.set(q <= S(0.0), Quality::impossible_dynamic_pressure);

    if (derives(Quantity::dynamic_ratio)) state[Quantity::dynamic_ratio] = q / p;
    if (derives(Quantity::mach)) state[Quantity::mach] = mach_number(p, q, dry_air<S>());
    if (derives(Quantity::airspeed_rate)) state[Quantity::airspeed_rate] = airspeed_rate(state);
    if (derives(Quantity::vapor_pressure)) {
      state[Quantity::vapor_pressure] = recorded_vapor_pressure(state, p);
    }
    flow_angles(state, parameters, flags);
    if (acts(Where::radome)) {
      // What the radome loses at an angle is found from the angles without that loss, which is small.
      add(Where::radome, Quantity::radome_dynamic_pressure, state, parameters);
      flow_angles(state, parameters, flags);
    }
    add(Where::attack, Quantity::attack, state, parameters);
    add(Where::sideslip, Quantity::sideslip, state, parameters);
    if (calibrates_recorded_temperature()) {
      S& ambient = state[Quantity::ambient_temperature];
      ambient = calibrated(above_zero(ambient), state, parameters, flags);
    }

    const S line = sum<S>(Where::static_line, state, parameters);
    state[Quantity::port_static_pressure] = p + sum<S>(Where::static_transducer, state, parameters) + line;
    state[Quantity::port_dynamic_pressure] = q + sum<S>(Where::dynamic_transducer, state, parameters) - line +
                                             sum<S>(Where::total_line, state, parameters) +
                                             sum<S>(Where::pitot, state, parameters);
    flags.set(!is_missing(p + q) &&
                  is_missing(state[Quantity::port_static_pressure] + state[Quantity::port_dynamic_pressure]),
              Quality::effect_input_missing);
  }

  /// Delta-p of the model, hPa: the sum of the effects at the static ports, under the policy. NaN where a
  /// pressure or an input of an effect is missing. Where the dynamic pressure is zero or below, no airflow
  /// causes a defect: zero under a taper, else NaN. A defect above the dynamic pressure is impossible: NaN.
  template <class S, class P, class Flags>
  Promoted<S, P> static_defect(const State<S>& state, const P* parameters, Flags& flags) const {
    using R = Promoted<S, P>;
    const S p = state[Quantity::static_pressure];
    const S q = state[Quantity::dynamic_pressure];
    R defect = sum<R>(Where::static_defect, state, parameters);
    const auto flowing = p > S(0.0) && q > S(0.0);
    flags.set(flowing && is_missing(defect), Quality::effect_input_missing);
    for (const Range& range : domain_) {
      const S value = state[range.quantity];
      flags.set(value < S(range.lower) || value > S(range.upper), Quality::outside_domain);
    }
    if (has_minimum()) {
      const auto below = defect < R(policy_.minimum);
      flags.set(below, Quality::minimum_applied);
      defect = select(below, R(policy_.minimum), defect);
    }
    if (policy_.taper_below > 0.0) {
      const auto slow = q < S(policy_.taper_below);
      flags.set(slow, Quality::tapered);
      if (any(slow)) defect = select(slow, taper(defect, q), defect);
    }
    const auto exceeds = flowing && defect > R(q);
    flags.set(exceeds, Quality::defect_exceeds_dynamic_pressure);
    defect = select(exceeds, missing<R>(), defect);
    const auto enough = policy_.taper_below > 0.0 ? p > S(0.0) && !is_missing(q) : flowing;
    return select(enough, defect, missing<R>());
  }

  /// Corrected pressures: p = p_port + delta-p, q = q_port - delta-p (memo eq. 1-3). Their sum stays. A
  /// negative q is impossible, as where a law is carried on to the ground: NaN.
  template <class S, class Flags>
  void correct(State<S>& state, const S& defect, Flags& flags) const {
    const S q = state[Quantity::port_dynamic_pressure] - defect;
    const auto negative = q < S(0.0);
    flags.set(negative, Quality::impossible_dynamic_pressure);
    state[Quantity::corrected_static_pressure] = state[Quantity::port_static_pressure] + defect;
    state[Quantity::corrected_dynamic_pressure] = select(negative, missing<S>(), q);
  }

  /// Humidity, Mach number, ambient temperature and airspeed from the corrected pressures. They depend on
  /// each other through the constants of moist air and the limit of saturation over water, so they are found
  /// together. An ambient temperature that is found from the recovery temperature is calibrated here.
  template <class S, class P, class Flags>
  void air(State<S>& state, const P* parameters, Flags& flags) const {
    const S p = state[Quantity::corrected_static_pressure];
    const S delta = sum<S>(Where::recovery, state, parameters);
    const S thermometer = recovery_temperature_of(state, parameters);
    if (has_temperature()) {
      S& ambient = state[Quantity::ambient_temperature];
      ambient = above_zero(ambient);
      flags.set(is_missing(derives_temperature() ? thermometer : ambient), Quality::temperature_missing);
      flags.set(is_missing(delta), Quality::effect_input_missing);
    }
    flags.set(p <= S(0.0), Quality::impossible_static_pressure);
    S humidity = recorded_humidity(state, parameters, p, flags);
    MoistAir<S> constants = solve_air(state, parameters, humidity, thermometer, delta, flags);
    // Most air is far from saturation; only where it may not be is saturation itself computed.
    if (counts_vapor() &&
        any(humidity * p > vapor_pressure_below_saturation(state[Quantity::ambient_temperature]))) {
      const S saturation = vapor_pressure_over_water(state[Quantity::ambient_temperature]) / p;
      const auto above = humidity > saturation;
      flags.set(above, Quality::humidity_limited);
      if (any(above)) {
        humidity = select(above, saturation, humidity);
        constants = solve_air(state, parameters, humidity, thermometer, delta, flags);
      }
    }
    state[Quantity::humidity] = humidity;
    state[Quantity::corrected_airspeed] =
        true_airspeed(state[Quantity::corrected_mach], state[Quantity::ambient_temperature], constants);
  }

  /// Delta-p that LAMS asks for at this sample, hPa, by the approach of the model. NaN where the laser or
  /// anything that it needs is missing.
  template <class S, class P, class Flags>
  S lams_static_defect(const State<S>& state, const P* parameters, Flags& flags) const {
    const S p = state[Quantity::port_static_pressure];
    const S q = state[Quantity::port_dynamic_pressure];
    const S v = lams_airspeed(state, parameters);
    S e = recorded_humidity(state, parameters, p, flags) * p;
    const S thermometer = recovery_temperature_of(state, parameters);
    const S delta = sum<S>(Where::recovery, state, parameters);
    const auto recovery = [this, &delta](const S& mach) { return recovery_(mach) + delta; };
    LamsSolution<S> solution = solve_lams(p, q, v, e, state, parameters, thermometer, recovery);
    if (counts_vapor() && any(e > vapor_pressure_below_saturation(solution.temperature))) {
      const S saturation = vapor_pressure_over_water(solution.temperature);
      const auto above = e > saturation;
      flags.set(above, Quality::humidity_limited);
      if (any(above)) {
        e = select(above, saturation, e);
        solution = solve_lams(p, q, v, e, state, parameters, thermometer, recovery);
      }
    }
    const auto valid = p > S(0.0) && q > S(0.0) && v > S(0.0);
    const S defect = select(valid, finite_or_missing(solution.static_defect), missing<S>());
    flags.set(is_missing(defect), Quality::lams_missing);
    return defect;
  }

  /// The true airspeed that LAMS measures, m/s: the speed along the beam over the cosine of its angle to the
  /// wind.
  template <class S, class P>
  S lams_airspeed(const State<S>& state, const P* parameters) const {
    const S elevation = S(lams_.elevation) + sum<S>(Where::beam_elevation, state, parameters);
    const S azimuth = S(lams_.azimuth) + sum<S>(Where::beam_azimuth, state, parameters);
    const S beam = state[Quantity::lams_airspeed] + sum<S>(Where::beam_speed, state, parameters);
    const S sideslip = needs(Quantity::sideslip) ? state[Quantity::sideslip] : S(0.0);
    return airspeed_from_beam(beam, beam_cosine(elevation, azimuth, state[Quantity::attack], sideslip));
  }

  /// Ambient temperature (K, eq. 12) and dynamic pressure (hPa, eq. 8) from LAMS and the corrected pressures.
  /// They test the model, not the laser: with pressures corrected by LAMS at this very sample they return
  /// their inputs.
  template <class S, class P>
  void lams_air(State<S>& state, const P* parameters) const {
    const S v = lams_airspeed(state, parameters);
    const MoistAir<S> constants = moist_air(state[Quantity::humidity]);
    state[Quantity::lams_temperature] = pcor::lams_temperature(v, state[Quantity::corrected_mach], constants);
    state[Quantity::lams_dynamic_pressure] = dynamic_pressure_from_airspeed(
        state[Quantity::corrected_static_pressure], v, state[Quantity::ambient_temperature], constants);
  }

 private:
  // An effect of the model: of the catalogue, or the formula of that number.
  struct Term {
    std::size_t effect = catalogue_size;
    std::size_t formula = 0;
    std::size_t first_parameter = 0;
    Where where = Where::static_defect;
  };

  static constexpr std::size_t formula_variable_capacity = 12;

  struct BoundFormula {
    Formula formula;
    std::vector<Quantity> variables;
  };

  struct Range {
    Quantity quantity;
    double lower;
    double upper;
  };

  class Builder;

  Chain() = default;

  std::size_t begin_of(Where where, std::size_t next = 0) const {
    return where_begin_[static_cast<std::size_t>(where) + next];
  }

  template <class R, class S, class P>
  R sum(Where where, const State<S>& state, const P* parameters) const {
    return acts(where) ? sum_of_terms<R>(where, state, parameters) : R(0.0);
  }

  template <class R, class S, class P>
  R sum_of_terms(Where where, const State<S>& state, const P* parameters) const {
    R total(0.0);
    for (std::size_t i = begin_of(where); i < begin_of(where, 1); ++i) {
      total = total + value(terms_[i], state, parameters + terms_[i].first_parameter);
    }
    return finite_or_missing(total);
  }

  template <class S, class P>
  Promoted<S, P> value(const Term& term, const State<S>& state, const P* parameters) const {
    if (term.effect != catalogue_size) return effect_functions<S, P>[term.effect](state, parameters);
    const BoundFormula& bound = formulas_[term.formula];
    std::array<S, formula_variable_capacity> variables;
    for (std::size_t i = 0; i < bound.variables.size(); ++i) variables[i] = state[bound.variables[i]];
    return bound.formula.value(variables.data(), parameters);
  }

  template <class S, class P>
  void add(Where where, Quantity quantity, State<S>& state, const P* parameters) const {
    if (acts(where)) state[quantity] = state[quantity] + sum<S>(where, state, parameters);
  }

  // The ratios of the radome pressures, and the angles of flow where they are found from these.
  template <class S, class P, class Flags>
  void flow_angles(State<S>& state, const P* parameters, Flags& flags) const {
    if (needs(Quantity::attack_ratio) || needs(Quantity::sideslip_ratio)) radome_ratios(state, flags);
    add(Where::attack_ratio, Quantity::attack_ratio, state, parameters);
    if (derives(Quantity::attack)) {
      state[Quantity::attack] = radome_angle(attack_radome_, Quantity::attack_ratio, state);
    }
    if (derives(Quantity::sideslip)) {
      state[Quantity::sideslip] = radome_angle(sideslip_radome_, Quantity::sideslip_ratio, state);
    }
  }

  template <class S, class Flags>
  void radome_ratios(State<S>& state, Flags& flags) const {
    const S q = state[Quantity::radome_dynamic_pressure];
    const auto flowing = q > S(0.0);
    flags.set(q <= S(0.0), Quality::impossible_radome_pressure);
    if (needs(Quantity::attack_ratio)) {
      state[Quantity::attack_ratio] =
          select(flowing, state[Quantity::attack_differential_pressure] / q, missing<S>());
    }
    if (needs(Quantity::sideslip_ratio)) {
      state[Quantity::sideslip_ratio] =
          select(flowing, state[Quantity::sideslip_differential_pressure] / q, missing<S>());
    }
  }

  template <class S>
  S radome_angle(const RadomeCalibration& radome, Quantity ratio, const State<S>& state) const {
    return radome.needs_mach() ? radome(state[ratio], state[Quantity::mach]) : radome(state[ratio]);
  }

  // Rate of change of the airspeed, m/s2, from the measured pressures, the temperature and their rates:
  //
  //     v^2 = 7 R_d T h,   h = (1 + q/p)^(2/7) - 1 = M^2/5,   T = T_r/(1 + a_r h)
  //     dv/dt = v/2 (dh/dt / h + dT/dt / T)
  //
  // in dry air and without the effects of the model, within some percent. NaN where q is not above zero.
  // Source: memo eq. 5-7.
  template <class S>
  S airspeed_rate(const State<S>& state) const {
    using std::sqrt;
    const S p = state[Quantity::static_pressure];
    const S q = state[Quantity::dynamic_pressure];
    const S heating = power_less_one(q, p, S(2.0 / 7.0));
    const S ratio_rate =
        (state[Quantity::dynamic_pressure_rate] - q / p * state[Quantity::static_pressure_rate]) / p;
    const S heating_rate = S(2.0 / 7.0) * (S(1.0) + heating) * p / (p + q) * ratio_rate;
    S temperature = state[Quantity::ambient_temperature];
    S relative_rate = state[Quantity::ambient_temperature_rate] / temperature;
    if (derives_temperature()) {
      const S recovered = state[Quantity::recovery_temperature];
      const S factor = recovery_(sqrt(S(5.0) * heating));
      const S warming = S(1.0) + factor * heating;
      temperature = recovered / warming;
      relative_rate =
          state[Quantity::recovery_temperature_rate] / recovered - factor * heating_rate / warming;
    }
    const S airspeed = sqrt(S(7.0 * constants::gas_constant_dry_air) * temperature * heating);
    return S(0.5) * airspeed * (heating_rate / heating + relative_rate);
  }

  bool has_minimum() const { return policy_.minimum > -std::numeric_limits<double>::infinity(); }

  template <class R, class S>
  R taper(const R& defect, const S& q) const {
    const S fraction = power(q * S(1.0 / policy_.taper_below), S(policy_.taper_power));
    return select(q > S(0.0), R(defect * fraction), R(0.0));
  }

  template <class S, class P>
  S recovery_temperature_of(const State<S>& state, const P* parameters) const {
    return above_zero(state[Quantity::recovery_temperature] + sum<S>(Where::temperature, state, parameters));
  }

  // No temperature is zero kelvin or below.
  template <class S>
  static S above_zero(const S& temperature) {
    return select(temperature > S(0.0), temperature, missing<S>());
  }

  // True where water vapour changes the constants of the air: with moist constants, or by an effect.
  bool counts_vapor() const { return moist_ || acts(Where::humidity); }

  // Vapour pressure as recorded, hPa; a dew point gives one at static pressure p.
  template <class S>
  S recorded_vapor_pressure(const State<S>& state, const S& p) const {
    if (recorded(Quantity::vapor_pressure)) return state[Quantity::vapor_pressure];
    if (recorded(Quantity::dew_point)) return vapor_pressure_from_dew_point(state[Quantity::dew_point], p);
    if (recorded(Quantity::frost_point)) {
      return vapor_pressure_from_frost_point(state[Quantity::frost_point], p);
    }
    return missing<S>();
  }

  // e/p at static pressure p, zero or above; zero where dry constants are asked for, nothing is recorded, or
  // e is not below p, which no air is.
  template <class S, class P, class Flags>
  S recorded_humidity(const State<S>& state, const P* parameters, const S& p, Flags& flags) const {
    if (!counts_vapor()) return S(0.0);
    const S vapor = recorded_vapor_pressure(state, p);
    S e = moist_ ? vapor : S(0.0);
    if (acts(Where::humidity)) {
      State<S> here = state;
      here[Quantity::vapor_pressure] = vapor;
      e = e + sum<S>(Where::humidity, here, parameters);
    }
    const auto unknown = !(e < p) && p > S(0.0);
    const auto negative = e < S(0.0);
    flags.set(unknown, Quality::dry_air_assumed);
    flags.set(negative, Quality::humidity_limited);
    return select(unknown || negative, S(0.0), e / p);
  }

  // The ambient temperature after the effects that calibrate it, which are found from it as it was before
  // them.
  template <class S, class P, class Flags>
  S calibrated(const S& temperature, const State<S>& state, const P* parameters, Flags& flags) const {
    State<S> here = state;
    here[Quantity::ambient_temperature] = temperature;
    const S change = sum<S>(Where::ambient_temperature, here, parameters);
    flags.set(is_missing(change) && !is_missing(temperature), Quality::effect_input_missing);
    return above_zero(S(temperature + change));
  }

  // The same as a function of the temperature alone.
  template <class S, class P>
  struct Calibration {
    const Chain& chain;
    const State<S>& state;
    const P* parameters;

    S operator()(const S& temperature) const {
      NoQualityFlags none;
      return chain.calibrated(temperature, state, parameters, none);
    }
  };

  template <class S, class P, class Recovery>
  LamsSolution<S> solve_lams(const S& p, const S& q, const S& v, const S& e, const State<S>& state,
                             const P* parameters, const S& thermometer, const Recovery& recovery) const {
    if (lams_.approach == LamsApproach::with_temperature)
      return lams_with_temperature(p, q, v, state[Quantity::ambient_temperature], e);
    const bool is_simultaneous = lams_.approach == LamsApproach::simultaneous;
    if (!acts(Where::ambient_temperature)) {
      return is_simultaneous ? lams_simultaneous(p, q, v, thermometer, e, recovery)
                             : lams_iterated(p, q, v, thermometer, e, recovery);
    }
    const Calibration<S, P> calibrate{*this, state, parameters};
    return is_simultaneous ? lams_simultaneous(p, q, v, thermometer, e, recovery, 5, calibrate)
                           : lams_iterated(p, q, v, thermometer, e, recovery, 1e-7, 30, calibrate);
  }

  template <class S, class P, class Flags>
  MoistAir<S> solve_air(State<S>& state, const P* parameters, const S& humidity, const S& thermometer,
                        const S& delta, Flags& flags) const {
    const MoistAir<S> constants = moist_air(humidity);
    const S mach = mach_number(state[Quantity::corrected_static_pressure],
                               state[Quantity::corrected_dynamic_pressure], constants);
    state[Quantity::corrected_mach] = mach;
    if (derives_temperature()) {
      S& ambient = state[Quantity::ambient_temperature];
      ambient = ambient_temperature(thermometer, mach, recovery_(mach) + delta, constants);
      if (acts(Where::ambient_temperature)) ambient = calibrated(ambient, state, parameters, flags);
    }
    return constants;
  }

  std::vector<Term> terms_;  // by place
  std::array<std::size_t, where_count + 1> where_begin_{};
  std::vector<BoundFormula> formulas_;
  std::vector<double> parameters_;
  std::vector<std::string> extra_names_;
  std::vector<Range> domain_;
  std::vector<Quantity> inputs_;
  std::bitset<state_capacity> recorded_;
  std::bitset<state_capacity> needed_;
  LamsMounting lams_;
  RecoveryFactor recovery_;
  RadomeCalibration attack_radome_;
  RadomeCalibration sideslip_radome_;
  Policy policy_;
  bool moist_ = true;
};

// Checks a model against what is recorded, and fills a chain.
class Chain::Builder {
 public:
  Builder(const Model& model, const std::vector<Quantity>& recorded, std::string& error)
      : model_(model), error_(error) {
    for (const Quantity quantity : recorded) chain_.recorded_.set(index(quantity));
  }

  bool run() {
    chain_.lams_ = model_.lams;
    chain_.recovery_ = model_.recovery;
    chain_.attack_radome_ = model_.attack_radome;
    chain_.sideslip_radome_ = model_.sideslip_radome;
    chain_.policy_ = model_.policy;
    chain_.moist_ = model_.moist;
    for (const Quantity pressure : {Quantity::static_pressure, Quantity::dynamic_pressure}) {
      if (!require(pressure, "the chain")) return false;
    }
    for (const ModelEffect& effect : model_.effects) {
      if (!(effect.is_formula() ? add_formula(effect) : add_effect(effect))) return false;
    }
    for (const DomainRange& range : model_.domain) {
      if (!add_range(range)) return false;
    }
    if (chain_.has_lams() && !require_lams()) return false;
    sort_terms();
    for (std::size_t i = 0; i < state_capacity; ++i) {
      if (chain_.recorded_[i]) chain_.inputs_.push_back(static_cast<Quantity>(i));
    }
    return true;
  }

  Chain take() { return std::move(chain_); }

 private:
  bool fail(std::string why) {
    error_ = std::move(why);
    return false;
  }

  static std::string quoted(std::string_view name) { return "'" + std::string(name) + "'"; }

  bool add_effect(const ModelEffect& effect) {
    const std::size_t place = effect_named(effect.id);
    if (place == catalogue_size) return fail("there is no effect " + quoted(effect.id));
    const EffectFacts& facts = effect_facts[place];
    if (effect.parameters.size() != facts.parameter_count()) {
      return fail("effect " + quoted(effect.id) + " takes " + std::to_string(facts.parameter_count()) +
                  " parameter(s), not " + std::to_string(effect.parameters.size()));
    }
    if (is_beyond_reach(facts.where)) return add_parameters(effect);
    if (!require_place(facts.where, "effect " + quoted(effect.id))) return false;
    for (std::size_t i = 0; i < facts.need_count(); ++i) {
      if (is_at_hand(facts.needs[i], facts.where)) continue;
      if (!require(facts.needs[i], "effect " + quoted(effect.id))) return false;
    }
    Term term;
    term.effect = place;
    term.where = facts.where;
    return add_term(term, effect);
  }

  bool add_formula(const ModelEffect& effect) {
    FormulaError formula_error;
    std::optional<Formula> formula = Formula::parse(effect.formula, effect.parameter_names, &formula_error);
    if (!formula) return fail("formula of effect " + quoted(effect.id) + ": " + formula_error.message);
    if (effect.parameters.size() != effect.parameter_names.size()) {
      return fail("effect " + quoted(effect.id) + " takes " + std::to_string(effect.parameter_names.size()) +
                  " parameter(s), not " + std::to_string(effect.parameters.size()));
    }
    if (formula->variables().size() > formula_variable_capacity) {
      return fail("formula of effect " + quoted(effect.id) + " uses more than " +
                  std::to_string(formula_variable_capacity) + " variables");
    }
    if (is_beyond_reach(effect.where)) return add_parameters(effect);
    if (!require_place(effect.where, "the formula of effect " + quoted(effect.id))) return false;
    BoundFormula bound{std::move(*formula), {}};
    for (const std::string& name : bound.formula.variables()) {
      Quantity quantity = quantity_named(name);
      if (quantity == Quantity::count && !find_extra(name, quantity)) {
        return fail("the formulas of the model use more than " + std::to_string(extra_capacity) +
                    " further variables");
      }
      if (!is_at_hand(quantity, effect.where) &&
          !require(quantity, "the formula of effect " + quoted(effect.id)))
        return false;
      bound.variables.push_back(quantity);
    }
    Term term;
    term.formula = chain_.formulas_.size();
    term.where = effect.where;
    chain_.formulas_.push_back(std::move(bound));
    return add_term(term, effect);
  }

  // Without a laser nothing acts on its beam, and what such an effect needs may be missing.
  bool is_beyond_reach(Where where) const {
    const bool on_beam =
        where == Where::beam_elevation || where == Where::beam_azimuth || where == Where::beam_speed;
    return on_beam && !chain_.has_lams();
  }

  // What an effect corrects is there, and is computed.
  bool require_place(Where where, const std::string& who) {
    if (where == Where::radome) return require(Quantity::radome_dynamic_pressure, who);
    if (where == Where::attack_ratio) return require(Quantity::attack_ratio, who);
    if (where == Where::ambient_temperature && !chain_.has_temperature()) {
      return fail(who +
                  " needs the role 'recovery_temperature' or 'ambient_temperature': name its variable in the "
                  "table [variables]");
    }
    return true;
  }

  // What calibrates the ambient temperature is found from it, derived or recorded.
  static bool is_at_hand(Quantity quantity, Where where) {
    return where == Where::ambient_temperature && quantity == Quantity::ambient_temperature;
  }

  bool add_term(Term term, const ModelEffect& effect) {
    term.first_parameter = chain_.parameters_.size();
    chain_.terms_.push_back(term);
    return add_parameters(effect);
  }

  bool add_parameters(const ModelEffect& effect) {
    chain_.parameters_.insert(chain_.parameters_.end(), effect.parameters.begin(), effect.parameters.end());
    return true;
  }

  // Finds the place of a further variable; a new one where the name is new. False where there is no room.
  bool find_extra(const std::string& name, Quantity& place) {
    std::vector<std::string>& names = chain_.extra_names_;
    const auto found = std::find(names.begin(), names.end(), name);
    const auto number = static_cast<std::size_t>(found - names.begin());
    if (number == extra_capacity) return false;
    place = extra_quantity(number);
    if (found == names.end()) {
      names.push_back(name);
      chain_.recorded_.set(index(place));
    }
    return true;
  }

  bool add_range(const DomainRange& range) {
    const Quantity quantity = quantity_named(range.quantity);
    if (quantity == Quantity::count) return fail("there is no quantity " + quoted(range.quantity));
    if (!require(quantity, "the domain of the model")) return false;
    chain_.domain_.push_back({quantity, range.lower, range.upper});
    return true;
  }

  bool require_lams() {
    if (!require(Quantity::attack, "LAMS, for the angle between its beam and the wind,")) return false;
    if (chain_.recorded(Quantity::sideslip) || model_.sideslip_radome.is_calibrated()) {
      if (!require(Quantity::sideslip, "LAMS")) return false;
    }
    const Quantity thermometer = model_.lams.approach == LamsApproach::with_temperature
                                     ? Quantity::ambient_temperature
                                     : Quantity::recovery_temperature;
    return require(thermometer, "LAMS");
  }

  // Marks a quantity and all that it is derived from as needed.
  bool require(Quantity quantity, const std::string& who) {
    chain_.needed_.set(index(quantity));
    if (chain_.recorded_[index(quantity)]) return true;
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
        return require_airspeed_rate(who);
      case Quantity::vapor_pressure:
        return require_vapor_pressure(who);
      case Quantity::attack_ratio:
        return require(Quantity::attack_differential_pressure, who) &&
               require(Quantity::radome_dynamic_pressure, who);
      case Quantity::sideslip_ratio:
        return require(Quantity::sideslip_differential_pressure, who) &&
               require(Quantity::radome_dynamic_pressure, who);
      case Quantity::attack:
        return require_angle(model_.attack_radome, quantity, Quantity::attack_ratio, who);
      case Quantity::sideslip:
        return require_angle(model_.sideslip_radome, quantity, Quantity::sideslip_ratio, who);
      default:
        return fail_missing(quantity, who);
    }
  }

  bool require_airspeed_rate(const std::string& who) {
    const bool ambient = chain_.recorded(Quantity::ambient_temperature);
    return require(Quantity::static_pressure_rate, who) && require(Quantity::dynamic_pressure_rate, who) &&
           require(ambient ? Quantity::ambient_temperature_rate : Quantity::recovery_temperature_rate, who);
  }

  bool require_vapor_pressure(const std::string& who) {
    for (const Quantity mirror : {Quantity::dew_point, Quantity::frost_point}) {
      if (chain_.recorded(mirror)) return require(mirror, who);
    }
    return fail_missing(Quantity::vapor_pressure, who);
  }

  bool require_angle(const RadomeCalibration& radome, Quantity angle, Quantity ratio,
                     const std::string& who) {
    const std::string name(facts_of(angle).name);
    if (!radome.is_calibrated()) {
      return fail(who + " needs the role '" + name +
                  "': name its variable in the table [variables], or give [radome] " + name +
                  " = [offset, slope] to derive it from the radome pressures");
    }
    if (radome.needs_mach() && !require(Quantity::mach, who)) return false;
    return require(ratio, who);
  }

  bool fail_missing(Quantity quantity, const std::string& who) {
    const std::string name(facts_of(quantity).name);
    if (!is_role(quantity))
      return fail(who + " needs " + quoted(name) + ", which is known only after delta-p");
    return fail(who + " needs the role " + quoted(name) + ": name its variable in the table [variables]");
  }

  void sort_terms() {
    std::stable_sort(chain_.terms_.begin(), chain_.terms_.end(),
                     [](const Term& a, const Term& b) { return a.where < b.where; });
    for (const Term& term : chain_.terms_) ++chain_.where_begin_[static_cast<std::size_t>(term.where) + 1];
    for (std::size_t i = 0; i < where_count; ++i) chain_.where_begin_[i + 1] += chain_.where_begin_[i];
  }

  const Model& model_;
  std::string& error_;
  Chain chain_;
};

inline std::optional<Chain> Chain::build(const Model& model, const std::vector<Quantity>& recorded,
                                         std::string* error) {
  std::string why;
  Builder builder(model, recorded, why);
  if (builder.run()) return builder.take();
  if (error != nullptr) *error = why;
  return std::nullopt;
}

}  // namespace pcor
