#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <pcor/model/plausible.hpp>
#include <pcor/model/quality.hpp>
#include <pcor/physics/air_data.hpp>
#include <pcor/physics/humidity.hpp>
#include <pcor/physics/lams.hpp>
#include <pcor/realtime/model_binder.hpp>

namespace pcor {

/// Dynamic pressure, hPa, from which an aircraft flies: 57 m/s at sea level.
inline constexpr double min_flight_pressure = 20.0;

/// True in flight for a delta-p, hPa, above six tenths of the dynamic pressure q, hPa, or below its negative:
/// no static port has such an error, twice the limit of the laser (`max_lams_departure`). False if one is
/// NaN.
template <class R, class S>
auto is_impossible_defect(const R& defect, const S& q) {
  const R limit(S(4.0 * max_lams_departure) * q);
  return q >= S(min_flight_pressure) && (defect > limit || defect < -limit);
}

/// Inverts the measurement, stage by stage, from recorded values to free air, for one model.
///
///     correct_inputs -> static_defect -> correct -> air -> LAMS temperature and dynamic pressure
///             -> lams_static_defect
///
/// Every stage reads and writes a `State`. It is a template over the scalars of the state, `S`, and of the
/// parameters, `P`, so that the same code serves the real-time loop (both `double`), batches (`S` a vector
/// pack) and fits (`P` a dual number). If effects act before the static ports, `S` must be the promoted type.
/// After `build` a chain does not allocate or throw, and keeps no data of samples.
class Chain : public BoundModel {
 public:
  /// Prepares `model` for states in which the roles `recorded` are known. Returns nullopt if the model cannot
  /// be used; `error` then holds the reason and the action.
  static std::optional<Chain> build(const Model& model, const std::vector<Quantity>& recorded,
                                    BindingError* error) {
    BindingError unasked;
    return made(ModelBinder::bind(model, recorded, error != nullptr ? *error : unasked));
  }

  /// Chain with one more effect at the end of its model, or nullopt with the reason in `error`.
  std::optional<Chain> with_effect(const ModelEffect& effect, BindingError* error) const {
    BindingError unasked;
    return made(ModelBinder::with_effect(*this, effect, error != nullptr ? *error : unasked));
  }

  /// Inputs of the effects: pressure ratios and flow angles, the pressures at the ports, and the calibration
  /// of a recorded ambient temperature. Implausible recorded values (`is_implausible`) are treated as
  /// missing.
  template <class S, class P, class Flags>
  void correct_inputs(State<S>& state, const P* parameters, Flags& flags) const {
    for (const Quantity input : inputs()) drop_implausible(input, state);
    const S p = state[Quantity::static_pressure];
    const S q = state[Quantity::dynamic_pressure];
    flags.set(is_missing(p), Quality::static_pressure_missing);
    flags.set(is_missing(q), Quality::dynamic_pressure_missing);
    flags.set(p < S(min_static_pressure), Quality::impossible_static_pressure);
    flags.set(q <= S(0.0) || (p >= S(min_static_pressure) && !is_subsonic(p, q)),
              Quality::impossible_dynamic_pressure);

    if (derives(Quantity::dynamic_ratio)) state[Quantity::dynamic_ratio] = q / p;
    if (derives(Quantity::mach)) state[Quantity::mach] = mach_number(p, q, dry_air<S>());
    if (derives(Quantity::vapor_pressure)) {
      state[Quantity::vapor_pressure] = recorded_vapor_pressure(state, p);
    }
    flow_angles(state, parameters, flags);
    if (acts(EffectLocation::radome)) {
      // Radome loss at an angle, computed from angles without that loss, which is small.
      add(EffectLocation::radome, Quantity::radome_dynamic_pressure, state, parameters);
      flow_angles(state, parameters, flags);
    }
    add(EffectLocation::attack, Quantity::attack, state, parameters);
    add(EffectLocation::sideslip, Quantity::sideslip, state, parameters);
    if (calibrates_recorded_temperature()) {
      S& ambient = state[Quantity::ambient_temperature];
      ambient = calibrated(ambient, state, parameters, flags);
    }

    const S line = sum<S>(EffectLocation::static_line, state, parameters);
    state[Quantity::port_static_pressure] =
        p + sum<S>(EffectLocation::static_transducer, state, parameters) + line;
    state[Quantity::port_dynamic_pressure] = q +
                                             sum<S>(EffectLocation::dynamic_transducer, state, parameters) -
                                             line + sum<S>(EffectLocation::total_line, state, parameters) +
                                             sum<S>(EffectLocation::pitot, state, parameters);
    flags.set(!is_missing(p + q) &&
                  is_missing(state[Quantity::port_static_pressure] + state[Quantity::port_dynamic_pressure]),
              Quality::effect_input_missing);
  }

  /// Delta-p of the model, hPa: the sum of the effects at the static ports, limited by the policy. NaN if a
  /// pressure or an input of an effect is missing; if the dynamic pressure is below the minimum of the policy
  /// (no airflow), unless a taper, which ends in zero, is used; above Mach 1 (`max_dynamic_ratio`); and if
  /// the absolute defect exceeds the dynamic pressure: above it the corrected dynamic pressure would be
  /// negative; below its negative the port error would be half of the corrected one, ten times that of static
  /// ports. A value that is impossible in flight (`is_impossible_defect`) has the bit `outside_domain`: an
  /// input of the law is wrong.
  template <class S, class P, class Flags>
  Promoted<S, P> static_defect(const State<S>& state, const P* parameters, Flags& flags) const {
    using R = Promoted<S, P>;
    const S& p = state[Quantity::static_pressure];
    const S& q = state[Quantity::dynamic_pressure];
    R defect = sum_at_ports(state, parameters);
    const bool is_tapered = policy_.taper_below > 0.0;
    const auto possible = p >= S(min_static_pressure) && is_subsonic(p, q);
    const auto flowing = possible && (is_tapered ? q > S(0.0) : is_flowing(q));
    flags.set(flowing && is_missing(defect), Quality::effect_input_missing);
    const auto enough = is_tapered ? possible && !is_missing(q) : flowing;
    for (const Range& range : domain_) {
      const S& value = state[range.quantity];
      flags.set(value < S(range.lower) || value > S(range.upper), Quality::outside_domain);
      flags.set(enough && is_missing(value) && !is_missing(defect), Quality::outside_domain);
    }
    if (watches_flaps_) flags.set(state[Quantity::flaps] > S(flaps_in), Quality::outside_domain);
    if (has_minimum()) {
      const auto below = is_below_minimum(defect, parameters);
      flags.set(below, Quality::minimum_applied);
      defect = select(
          below, R(policy_.minimum) + amount_added_at<R>(EffectLocation::static_defect, parameters), defect);
    }
    if (is_tapered) {
      const auto slow = q < S(policy_.taper_below);
      flags.set(slow, Quality::tapered);
      if (any(slow)) defect = select(slow, taper(defect, q), defect);
    }
    flags.set(is_impossible_defect(defect, q), Quality::outside_domain);
    const auto is_too_large = possible && q > S(0.0) && exceeds(defect, R(q));
    flags.set(is_too_large, Quality::defect_exceeds_dynamic_pressure);
    defect = select(is_too_large, missing<R>(), defect);
    return select(enough, defect, missing<R>());
  }

  /// True if a quantity is outside the domain of the law, or missing, if the flaps are extended without an
  /// effect that reads them, or if delta-p is impossible in flight: the uncertainty of the law does not
  /// apply. The envelope of a surface does not count. False without delta-p.
  bool is_outside_domain(const State<double>& state) const {
    const double defect = state[Quantity::static_defect];
    if (is_missing(defect)) return false;
    if (is_impossible_defect(defect, state[Quantity::dynamic_pressure])) return true;
    if (watches_flaps_ && state[Quantity::flaps] > flaps_in) return true;
    return std::any_of(domain_.begin(), domain_.end(), [&state](const Range& range) {
      const double value = state[range.quantity];
      return !range.is_of_surface && !(value >= range.lower && value <= range.upper);
    });
  }

  /// Corrected pressures: p = p_port + delta-p, q = q_port - delta-p (memo eq. 1-3). Their sum is unchanged.
  /// Negative values, as from extrapolation to the ground, and implausible ones are NaN.
  template <class S, class Flags>
  void correct(State<S>& state, const S& defect, Flags& flags) const {
    put(Quantity::corrected_static_pressure, S(state[Quantity::port_static_pressure] + defect), state, flags,
        Quality::impossible_static_pressure);
    put(Quantity::corrected_dynamic_pressure, S(state[Quantity::port_dynamic_pressure] - defect), state,
        flags, Quality::impossible_dynamic_pressure);
  }

  /// Humidity, Mach number, ambient temperature and airspeed from the corrected pressures. They depend on
  /// each other through the constants of moist air and the limit of saturation over water, so they are solved
  /// together. An ambient temperature derived from the recovery temperature is calibrated here. If the
  /// corrected dynamic pressure is below the minimum of the policy, as on the ramp, Mach number and airspeed
  /// would be noise and are NaN; the temperature, hardly affected by such a flow, is kept if both corrected
  /// pressures are known. An implausible Mach number indicates an impossible pair of pressures.
  template <class S, class P, class Flags>
  void air(State<S>& state, const P* parameters, Flags& flags) const {
    const S p = state[Quantity::corrected_static_pressure];
    const S delta = sum<S>(EffectLocation::recovery, state, parameters);
    const S thermometer = recovery_temperature_of(state, parameters);
    const auto temperature = [&] {
      return has_temperature() ? state[Quantity::ambient_temperature] : missing<S>();
    };
    if (has_temperature()) {
      const S& ambient = state[Quantity::ambient_temperature];
      // A functor may have written it after `correct_inputs`.
      if (!derives_temperature()) drop_implausible(Quantity::ambient_temperature, state);
      flags.set(is_missing(derives_temperature() ? thermometer + delta : ambient),
                Quality::temperature_missing);
      flags.set(is_missing(delta), Quality::effect_input_missing);
    }
    S humidity = recorded_humidity(state, parameters, p, flags);
    AirOf<S> air = solve_air(state, parameters, humidity, thermometer, delta, flags);
    if (limit_to_saturation(humidity, p, temperature(), flags))
      air = solve_air(state, parameters, humidity, thermometer, delta, flags);
    const S least(policy_.min_dynamic_pressure);
    const S& q = state[Quantity::corrected_dynamic_pressure];
    const auto still = q < least;
    // Without a corrected pressure the measured one decides.
    flags.set(still || (is_missing(q) && state[Quantity::dynamic_pressure] < least), Quality::no_airflow);
    S& mach = state[Quantity::corrected_mach];
    put(Quantity::corrected_mach, select(still, missing<S>(), mach), state, flags,
        Quality::impossible_dynamic_pressure);
    state[Quantity::humidity] = humidity;
    state[Quantity::corrected_airspeed] =
        select(is_missing(mach), missing<S>(),
               true_airspeed_from_heating(air.heating, temperature(), air.constants));
  }

  /// Delta-p from LAMS at this sample, hPa, by the approach of the model. NaN if the laser or another input
  /// is missing, without airflow, above Mach 1, and if its absolute value exceeds the dynamic pressure,
  /// because the laser airspeed must then be wrong.
  template <class S, class P, class Flags>
  S lams_static_defect(const State<S>& state, const P* parameters, Flags& flags) const {
    const S& p = state[Quantity::port_static_pressure];
    const S& q = state[Quantity::port_dynamic_pressure];
    const S v = lams_airspeed(state, parameters);
    S e = recorded_humidity(state, parameters, p, flags) * p;
    const S thermometer = recovery_temperature_of(state, parameters);
    const S delta = sum<S>(EffectLocation::recovery, state, parameters);
    const auto recovery = [this, &delta](const S& mach) { return recovery_(mach) + delta; };
    LamsSolution<S> solution = solve_lams(p, q, v, e, state, parameters, thermometer, recovery);
    NoQualityFlags provisional;  // `air` marks a limited humidity of the results
    if (limit_to_saturation(e, S(1.0), solution.temperature, provisional))
      solution = solve_lams(p, q, v, e, state, parameters, thermometer, recovery);
    const S found =
        finite_or_missing(plausible_or_missing(Quantity::lams_static_defect, solution.static_defect));
    const auto valid =
        p >= S(min_static_pressure) && is_subsonic(p, q) && is_flowing(q) && v > S(0.0) && !exceeds(found, q);
    const S defect = select(valid, found, missing<S>());
    flags.set(is_missing(defect), Quality::lams_missing);
    return defect;
  }

  /// The cosine of the angle between the beam of the laser and the wind.
  template <class S, class P>
  S cosine_of_beam(const State<S>& state, const P* parameters) const {
    const S elevation = S(lams_.elevation) + sum<S>(EffectLocation::beam_elevation, state, parameters);
    const S azimuth = S(lams_.azimuth) + sum<S>(EffectLocation::beam_azimuth, state, parameters);
    const S sideslip = needs(Quantity::sideslip) ? state[Quantity::sideslip] : S(0.0);
    return beam_cosine(elevation, azimuth, state[Quantity::attack], sideslip);
  }

  /// Airspeed along the laser beam from the corrected pressures, m/s; the true airspeed without a laser. For
  /// a state with recorded values and rates of change. NaN if an input is missing.
  template <class S, class P>
  S airspeed_along_beam(State<S> state, const P* parameters) const {
    NoQualityFlags flags;
    correct_inputs(state, parameters, flags);
    correct(state, static_defect(state, parameters, flags), flags);
    air(state, parameters, flags);
    const S airspeed = state[Quantity::corrected_airspeed];
    return has_lams() ? airspeed * cosine_of_beam(state, parameters) : airspeed;
  }

  /// The true airspeed that LAMS measures, m/s: the speed along the beam over the cosine of its angle to the
  /// wind.
  template <class S, class P>
  S lams_airspeed(const State<S>& state, const P* parameters) const {
    const S beam = state[Quantity::lams_airspeed] + sum<S>(EffectLocation::beam_speed, state, parameters);
    return airspeed_from_beam(beam, cosine_of_beam(state, parameters));
  }

  /// Ambient temperature (K, eq. 12) and dynamic pressure (hPa, eq. 8) from LAMS and the corrected pressures.
  /// They test the model, not the laser: with pressures corrected by LAMS at the same sample they return
  /// their inputs. NaN if the airspeed of the laser is missing or not positive, or results are implausible.
  template <class S, class P, class Flags>
  void lams_air(State<S>& state, const P* parameters, Flags& flags) const {
    const S recorded = lams_airspeed(state, parameters);
    const S v = select(recorded > S(0.0), recorded, missing<S>());
    const MoistAir<S> constants = moist_air(state[Quantity::humidity]);
    put(Quantity::lams_temperature, pcor::lams_temperature(v, state[Quantity::corrected_mach], constants),
        state, flags, Quality::lams_missing);
    put(Quantity::lams_dynamic_pressure,
        dynamic_pressure_from_airspeed(state[Quantity::corrected_static_pressure], v,
                                       state[Quantity::ambient_temperature], constants),
        state, flags, Quality::lams_missing);
  }

  /// True if the sum of the effects at the static ports is exactly linear in a coefficient. Delta-p is then
  /// linear in it, except for a change from or to the minimum of the policy.
  bool is_static_sum_linear(std::size_t effect, std::size_t parameter) const {
    return location_of(effect) == EffectLocation::static_defect && is_linear(effect, parameter);
  }

  /// Sum of the effects and of additional amounts at the static ports, hPa: delta-p without the policy.
  template <class S, class P>
  Promoted<S, P> sum_at_ports(const State<S>& state, const P* parameters) const {
    return sum<Promoted<S, P>>(EffectLocation::static_defect, state, parameters);
  }

  /// Where the policy raises delta-p to its minimum.
  template <class S, class P>
  auto is_at_minimum(const State<S>& state, const P* parameters) const {
    return is_below_minimum(sum_at_ports(state, parameters), parameters);
  }

  /// Taper factor of the effects at the static ports: 1 without a taper.
  template <class S>
  S taper_fraction(const State<S>& state) const {
    const S& q = state[Quantity::dynamic_pressure];
    const auto slow = q < S(policy_.taper_below);
    return any(slow) ? select(slow, taper(S(1.0), q), S(1.0)) : S(1.0);
  }

  /// Minimum of delta-p by the policy, hPa; minus infinity if the policy has no minimum.
  double minimum_defect() const { return policy_.minimum; }
  bool has_minimum() const { return policy_.minimum > -std::numeric_limits<double>::infinity(); }

  /// Minimum static pressure, hPa: that at 48 km height, far below the resolution of any sensor. Ratios to
  /// smaller pressures are not meaningful.
  static constexpr double min_static_pressure = 1.0;

 private:
  static constexpr double min_radome_pressure = 1e-6;  // hPa

  explicit Chain(BoundModel bound) : BoundModel(std::move(bound)) {}

  static std::optional<Chain> made(std::optional<BoundModel> bound) {
    return bound ? std::optional<Chain>(Chain(std::move(*bound))) : std::nullopt;
  }

  // Removes an implausible value from the state. True if there was one.
  template <class S>
  static auto drop_implausible(Quantity quantity, State<S>& state) {
    const auto implausible = is_implausible(quantity, state[quantity]);
    if (any(implausible)) state[quantity] = select(implausible, missing<S>(), state[quantity]);
    return implausible;
  }

  // Puts a result into the state; one that no flight has is missing, and sets the bit.
  template <class S, class Flags>
  static void put(Quantity quantity, const S& value, State<S>& state, Flags& flags, Quality bit) {
    state[quantity] = value;
    flags.set(drop_implausible(quantity, state), bit);
  }

  template <class S, class P>
  void add(EffectLocation location, Quantity quantity, State<S>& state, const P* parameters) const {
    if (acts(location)) state[quantity] = state[quantity] + sum<S>(location, state, parameters);
  }

  // Ratios of the radome pressures, and the flow angles derived from them.
  template <class S, class P, class Flags>
  void flow_angles(State<S>& state, const P* parameters, Flags& flags) const {
    if (needs(Quantity::attack_ratio) || needs(Quantity::sideslip_ratio)) radome_ratios(state, flags);
    // Before the attack ratio, whose effects may depend on the sideslip.
    if (derives(Quantity::sideslip)) {
      state[Quantity::sideslip] = plausible_or_missing(
          Quantity::sideslip, radome_angle(sideslip_radome_, Quantity::sideslip_ratio, state));
    }
    add(EffectLocation::attack_ratio, Quantity::attack_ratio, state, parameters);
    if (derives(Quantity::attack)) {
      state[Quantity::attack] =
          plausible_or_missing(Quantity::attack, radome_angle(attack_radome_, Quantity::attack_ratio, state));
    }
  }

  template <class S, class Flags>
  void radome_ratios(State<S>& state, Flags& flags) const {
    const S q = state[Quantity::radome_dynamic_pressure];
    const auto still = q < S(min_radome_pressure);
    flags.set(still, Quality::impossible_radome_pressure);
    if (needs(Quantity::attack_ratio)) {
      state[Quantity::attack_ratio] =
          select(still, missing<S>(), S(state[Quantity::attack_differential_pressure] / q));
    }
    if (needs(Quantity::sideslip_ratio)) {
      state[Quantity::sideslip_ratio] =
          select(still, missing<S>(), S(state[Quantity::sideslip_differential_pressure] / q));
    }
  }

  template <class S>
  S radome_angle(const RadomeCalibration& radome, Quantity ratio, const State<S>& state) const {
    return radome.needs_mach() ? radome(state[ratio], state[Quantity::mach]) : radome(state[ratio]);
  }

  // Whether the effects at the static ports, without additional amounts, are below the minimum.
  template <class R, class P>
  auto is_below_minimum(const R& sum, const P* parameters) const {
    return sum - amount_added_at<R>(EffectLocation::static_defect, parameters) < R(policy_.minimum);
  }

  // True if the dynamic pressure exceeds the noise of its sensor.
  template <class S>
  auto is_flowing(const S& q) const {
    return q > S(0.0) && q >= S(policy_.min_dynamic_pressure);
  }

  // Also true if one is missing.
  template <class S>
  static auto is_subsonic(const S& p, const S& q) {
    return !(q > S(max_dynamic_ratio) * p);
  }

  template <class S>
  static auto exceeds(const S& defect, const S& largest) {
    return defect > largest || defect < -largest;
  }

  template <class R, class S>
  R taper(const R& defect, const S& q) const {
    const S fraction = power(q * S(1.0 / policy_.taper_below), S(policy_.taper_power));
    return select(q > S(0.0), R(defect * fraction), R(0.0));
  }

  template <class S, class P>
  S recovery_temperature_of(const State<S>& state, const P* parameters) const {
    const S sensed =
        state[Quantity::recovery_temperature] + sum<S>(EffectLocation::temperature, state, parameters);
    return plausible_or_missing(Quantity::recovery_temperature, sensed);
  }

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

  // Vapour pressure ratio e/p at static pressure p, zero or above; zero if dry constants are selected, no
  // humidity is recorded, or e is not below p.
  template <class S, class P, class Flags>
  S recorded_humidity(const State<S>& state, const P* parameters, const S& p, Flags& flags) const {
    if (!counts_vapor()) return S(0.0);
    const S vapor = recorded_vapor_pressure(state, p);
    S e = moist_ ? vapor : S(0.0);
    if (acts(EffectLocation::humidity)) {
      State<S> here = state;
      here[Quantity::vapor_pressure] = vapor;
      e = e + sum<S>(EffectLocation::humidity, here, parameters);
    }
    const auto unknown = !(e < p) && p > S(0.0);
    const auto negative = e < S(0.0);
    flags.set(unknown, Quality::dry_air_assumed);
    flags.set(negative, Quality::humidity_limited);
    return select(unknown || negative, S(0.0), e / p);
  }

  // Limits a vapour pressure in units of `unit`, hPa, to saturation over water. True if any value was above.
  template <class S, class Flags>
  bool limit_to_saturation(S& vapor, const S& unit, const S& temperature, Flags& flags) const {
    // Saturation is computed only for air that may be saturated.
    if (!counts_vapor() || !any(vapor * unit > vapor_pressure_below_saturation(temperature))) return false;
    const S saturation = vapor_pressure_over_water(temperature) / unit;
    const auto above = vapor > saturation;
    flags.set(above, Quality::humidity_limited);
    if (!any(above)) return false;
    vapor = select(above, saturation, vapor);
    return true;
  }

  // Ambient temperature after calibration effects, whose input is the temperature before them.
  template <class S, class P, class Flags>
  S calibrated(const S& temperature, const State<S>& state, const P* parameters, Flags& flags) const {
    State<S> here = state;
    here[Quantity::ambient_temperature] = temperature;
    const S change = sum<S>(EffectLocation::ambient_temperature, here, parameters);
    flags.set(is_missing(change) && !is_missing(temperature), Quality::effect_input_missing);
    const S calibrated = temperature + change;
    flags.set(is_implausible(Quantity::ambient_temperature, calibrated) ||
                  (is_missing(calibrated) && !is_missing(temperature)),
              Quality::temperature_missing);
    return plausible_or_missing(Quantity::ambient_temperature, calibrated);
  }

  // Ambient temperature calibration as a function of the temperature only.
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
    if (!acts(EffectLocation::ambient_temperature)) {
      return is_simultaneous ? lams_simultaneous(p, q, v, thermometer, e, recovery)
                             : lams_iterated(p, q, v, thermometer, e, recovery);
    }
    const Calibration<S, P> calibrate{*this, state, parameters};
    return is_simultaneous ? lams_simultaneous(p, q, v, thermometer, e, recovery, 5, calibrate)
                           : lams_iterated(p, q, v, thermometer, e, recovery, 1e-7, 30, calibrate);
  }

  // Results of the solution of a sample that are used later: the constants of its air, and its dynamic
  // heating.
  template <class S>
  struct AirOf {
    MoistAir<S> constants;
    S heating;
  };

  template <class S, class P, class Flags>
  AirOf<S> solve_air(State<S>& state, const P* parameters, const S& humidity, const S& thermometer,
                     const S& delta, Flags& flags) const {
    const MoistAir<S> constants = moist_air(humidity);
    const S heating = dynamic_heating(state[Quantity::corrected_static_pressure],
                                      state[Quantity::corrected_dynamic_pressure], constants);
    state[Quantity::corrected_mach] = mach_number_from_heating(heating, constants);
    if (derives_temperature()) {
      S& ambient = state[Quantity::ambient_temperature];
      put(Quantity::ambient_temperature,
          ambient_temperature_from_heating(
              thermometer, heating,
              S(recovery_.at_square(S(constants.degrees_of_freedom * heating)) + delta)),
          state, flags, Quality::temperature_missing);
      flags.set(is_missing(ambient) && !is_missing(thermometer + heating), Quality::temperature_missing);
      if (acts(EffectLocation::ambient_temperature)) ambient = calibrated(ambient, state, parameters, flags);
    }
    return {constants, heating};
  }
};

}  // namespace pcor
