#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pcor/model/uncertainty.hpp>
#include <pcor/realtime/functor.hpp>
#include <pcor/realtime/look_ahead.hpp>
#include <pcor/realtime/stages.hpp>

namespace pcor {

/// A result of the loop and its standard uncertainty, which is in the same unit.
struct UncertainResult {
  Quantity result;
  Quantity uncertainty;
};

inline constexpr std::array<UncertainResult, 5> uncertain_results{{
    {Quantity::static_defect, Quantity::static_defect_uncertainty},
    {Quantity::corrected_static_pressure, Quantity::corrected_static_pressure_uncertainty},
    {Quantity::corrected_dynamic_pressure, Quantity::corrected_dynamic_pressure_uncertainty},
    {Quantity::ambient_temperature, Quantity::ambient_temperature_uncertainty},
    {Quantity::corrected_airspeed, Quantity::corrected_airspeed_uncertainty},
}};

/// The standard uncertainties of delta-p, corrected pressures, ambient temperature and airspeed of every
/// sample, by the law of propagation (GUM 5.2.2):
///
///     u^2 = g' C g + sum_i (dy/dx_i u_i)^2
///
/// with g the derivatives of the result with respect to the coefficients, C their covariance, and u_i the
/// random uncertainty of each input of the sample, of its rate of change (for lags), and of the model.
/// Derivatives with respect to nonlinear coefficients are differences over two of their standard
/// uncertainties (GUM 5.1.3, note 2). Those with respect to pressures, temperature and humidity use the
/// equations of the air with the constants of dry air, accurate to 2 % of the uncertainty. They change
/// slowly, so a sample reuses uncertainties computed less than a second ago at pressures within 5 %, to
/// limit the cost at 25 Hz. Outside its envelope a surface is flat, and its error grows by the rms slope
/// inside the envelope. docs/uncertainty.md lists the contributions.
///
/// If delta-p is raised to the minimum of the model, it keeps the uncertainty of the model. If it is tapered,
/// the contributions of coefficients and inputs are tapered, too; the model's own uncertainty of delta-p is
/// not. If a result is missing, its uncertainty is missing. Outside the domain of the law all uncertainties
/// are missing, because the law was not fitted there. If LAMS corrects the
/// sample, only the uncertainty of the model's delta-p is given, because the model covariance does not apply
/// to the laser.
class ResultUncertainty final : public Functor {
 public:
  /// nullptr if `uncertainty` does not match the model of `chain`, with the reason in `error`.
  /// @param look_ahead of the rates of change that effects read, for their noise; nullptr without such
  /// effects
  static std::unique_ptr<ResultUncertainty> build(std::shared_ptr<const Chain> chain,
                                                  const ModelUncertainty& uncertainty, CorrectWith with,
                                                  std::string* error, const LookAhead* look_ahead = nullptr) {
    const auto fail = [error](std::string why) {
      if (error != nullptr) *error = std::move(why);
      return nullptr;
    };
    const std::size_t count = chain->parameters().size();
    if (!uncertainty.covariance.empty()) {
      if (uncertainty.covariance.size() != count * count) {
        return fail("the covariance is not of this model, which has " + std::to_string(count) +
                    " parameter(s)");
      }
      if (!is_covariance(uncertainty.covariance, count)) {
        return fail("the covariance of the model's parameters gives a negative variance");
      }
    }
    return std::unique_ptr<ResultUncertainty>(
        new ResultUncertainty(std::move(chain), uncertainty, with, look_ahead));
  }

  void reset() noexcept override { is_complete_ = false; }

  void compute(State<double>& state, QualityFlags& flags) noexcept override {
    if (!still_holds(state)) find(state);
    // The product makes the uncertainty missing if the result is missing, and outside the domain of the law.
    const double zero = chain_->is_outside_domain(state) ? missing<double>() : 0.0;
    for (std::size_t i = 0; i < uncertain_results.size(); ++i)
      state[uncertain_results[i].uncertainty] = found_[i] + zero * state[uncertain_results[i].result];
    if (flags.has(Quality::corrected_with_lams)) {
      for (std::size_t i = 1; i < uncertain_results.size(); ++i)
        state[uncertain_results[i].uncertainty] = missing<double>();
    }
  }

 private:
  /// One value for each of `uncertain_results`.
  using Results = std::array<double, uncertain_results.size()>;

  /// Changes of the inputs of the corrected air.
  struct Changes {
    double static_defect = 0.0;
    double static_pressure = 0.0;   // static pressure at the port, hPa
    double dynamic_pressure = 0.0;  // dynamic pressure at the ports, hPa
    double thermometer = 0.0;
    double recovery = 0.0;
    double ambient = 0.0;  // before its calibration
    double calibration = 0.0;
    double vapor = 0.0;
  };

  /// Sensitivity of the results of one sample to such changes. With h = (1 + q/p)^(R/c_p) - 1 = M^2 (gamma -
  /// 1)/2:
  ///
  ///     dh = R/c_p (1 + h) (dq - q/p dp)/(p + q),   T = T_r/(1 + a_r h),   v^2 = 2 c_p T h
  ///
  /// and for the vapour, x = e/p: dR/R = (1 - eps) dx, d(R/c_p) = -R/c_p dx/7, d(1/(gamma - 1)) = dx/5 of it.
  struct Sensitivity {
    Sensitivity(const Chain& chain, const State<double>& state) {
      const double p = state[Quantity::corrected_static_pressure];
      const double q = state[Quantity::corrected_dynamic_pressure];
      const double mach = state[Quantity::corrected_mach];
      const double temperature = state[Quantity::ambient_temperature];
      const bool is_still = is_missing(mach);  // ramp: the temperature still has an uncertainty
      const double heating = is_still ? 0.0 : 0.2 * mach * mach;
      const double by_pressure = 1.0 / p;
      ratio = q * by_pressure;
      heating_by_dynamic = (2.0 / 7.0) * (1.0 + heating) / (p + q);
      heating_by_vapor = -(1.0 / 7.0) * heating * (1.0 + 0.5 * heating) * by_pressure;
      if (chain.derives_temperature()) {
        double rest = temperature / state[Quantity::recovery_temperature];
        double factor = 0.0;
        if (chain.acts(EffectLocation::temperature) || chain.acts(EffectLocation::recovery) ||
            chain.acts(EffectLocation::ambient_temperature)) {
          const double* parameters = chain.parameters().data();
          factor = is_still ? 1.0 : chain.recovery_factor(mach, state, parameters);
          rest = 1.0 / (1.0 + factor * heating);
          calibration = chain.calibration_slope(state, parameters);
          temperature_by_heating = -temperature * factor * rest;
        } else {
          temperature_by_heating = is_still ? -temperature : -temperature * (1.0 - rest) / heating;
        }
        temperature_by_thermometer = rest;
        temperature_by_recovery = -temperature * heating * rest;
      } else if (chain.calibrates_recorded_temperature()) {
        calibration = chain.calibration_slope(state, chain.parameters().data());
      }
      half_airspeed = 0.5 * state[Quantity::corrected_airspeed];
      by_heating = 1.0 / heating;
      by_temperature = 1.0 / temperature;
      by_vapor = 0.52 * by_pressure;
    }

    Results of(const Changes& changes) const {
      const double p = changes.static_pressure + changes.static_defect;
      const double q = changes.dynamic_pressure - changes.static_defect;
      const double heating = heating_by_dynamic * (q - ratio * p) + heating_by_vapor * changes.vapor;
      const double before = temperature_by_heating * heating +
                            temperature_by_thermometer * changes.thermometer +
                            temperature_by_recovery * changes.recovery + changes.ambient;
      const double temperature = calibration * before + changes.calibration;
      const double airspeed =
          half_airspeed * (heating * by_heating + temperature * by_temperature + by_vapor * changes.vapor);
      return {changes.static_defect, p, q, temperature, airspeed};
    }

    double ratio = 0.0;
    double heating_by_dynamic = 0.0;
    double heating_by_vapor = 0.0;
    double temperature_by_heating = 0.0;
    double temperature_by_thermometer = 0.0;
    double temperature_by_recovery = 0.0;
    double calibration = 1.0;
    double half_airspeed = 0.0;
    double by_heating = 0.0;
    double by_temperature = 0.0;
    double by_vapor = 0.0;
  };

  /// A coefficient with a standard uncertainty.
  struct Coefficient {
    std::size_t effect;
    std::size_t number;  // index among the coefficients of its effect
    bool is_linear;
    // Coefficients of its effect: if linear, one for this coefficient and zero for the others in which it is
    // linear.
    std::vector<double> coefficients;
    double step;         // its standard uncertainty
    double shape = 0.0;  // derivative of the effect's value for this sample
  };

  /// Uncertain coefficients that act at one location.
  struct LocationTerms {
    EffectLocation location;
    std::size_t begin;
    std::size_t end;
    Results by_amount{};  // sensitivity for this sample
  };

  /// Error of a surface outside its envelope, where the surface is constant but the true coefficient may vary
  /// as inside.
  struct FlatOutside {
    Surface surface;
    double slope;  // rms difference of neighbouring coefficients

    double distance(const State<double>& state) const {
      return surface.distance(state[surface.axes[0].quantity], state[surface.axes[1].quantity]);
    }
  };

  /// A role whose value is uncertain in every sample.
  struct Noise {
    Quantity role;
    double size;
    bool moves_law;  // effects at the ports read it, or a quantity computed from it
  };

  /// A rate of change with the noise of its quantity, which the filter of the rate passes.
  struct RateNoise {
    Quantity rate;
    double size;                       // per second
    std::vector<std::size_t> effects;  // effects at the locations where the rate is read
  };

  ResultUncertainty(std::shared_ptr<const Chain> chain, const ModelUncertainty& uncertainty, CorrectWith with,
                    const LookAhead* look_ahead)
      : Functor(reads(*chain, with), writes()),
        chain_(std::move(chain)),
        static_defect_(uncertainty.static_defect),
        static_defect_ratio_(uncertainty.static_defect_ratio) {
    for (std::size_t effect = 0; effect < chain_->effect_count(); ++effect) {
      const EffectLocation location = chain_->location_of(effect);
      if (location == EffectLocation::static_defect || is_before_ports(location)) at_ports_.push_back(effect);
    }
    if (!uncertainty.covariance.empty()) {
      add_coefficients(uncertainty.covariance);
      add_surfaces(uncertainty.covariance);
    }
    Quantities read_at_ports;
    for (std::size_t number = 0; number < location_count; ++number) {
      const auto location = static_cast<EffectLocation>(number);
      if (location != EffectLocation::static_defect && !is_before_ports(location)) continue;
      for (const Quantity read : chain_->read_at(location)) {
        read_at_ports = joined({read_at_ports, MeasuredQuantities::sources(*chain_, read)});
      }
    }
    for (std::size_t i = 0; i < role_count; ++i) {
      const auto role = static_cast<Quantity>(i);
      if (!(uncertainty.random[i] > 0.0 && chain_->recorded(role))) continue;
      const bool is_vapor =
          role == Quantity::vapor_pressure || role == Quantity::dew_point || role == Quantity::frost_point;
      if (is_vapor && !chain_->counts_vapor()) continue;
      const bool moves_law =
          std::find(read_at_ports.begin(), read_at_ports.end(), role) != read_at_ports.end();
      noises_.push_back({role, uncertainty.random[i], moves_law});
    }
    if (look_ahead != nullptr) add_rates(uncertainty, *look_ahead);
  }

  void add_rates(const ModelUncertainty& uncertainty, const LookAhead& look_ahead) {
    for (const Rate& each : rates) {
      RateNoise noise{
          each.rate, look_ahead.noise_of(each.rate) * uncertainty.random[index(each.quantity)], {}};
      if (!(noise.size > 0.0)) continue;
      for (std::size_t effect = 0; effect < chain_->effect_count(); ++effect) {
        const Quantities read = chain_->read_at(chain_->location_of(effect));
        if (std::find(read.begin(), read.end(), each.rate) != read.end()) noise.effects.push_back(effect);
      }
      rate_noises_.push_back(std::move(noise));
    }
  }

  static Quantities reads(const Chain& chain, CorrectWith with) {
    Quantities read{Quantity::static_defect, Quantity::corrected_static_pressure,
                    Quantity::corrected_dynamic_pressure, Quantity::corrected_mach};
    if (chain.has_temperature()) {
      read.insert(read.end(), {Quantity::ambient_temperature, Quantity::corrected_airspeed});
    }
    if (with == CorrectWith::lams) read.push_back(Quantity::lams_static_defect);
    return read;
  }

  static Quantities writes() {
    Quantities written;
    for (const UncertainResult& each : uncertain_results) written.push_back(each.uncertainty);
    return written;
  }

  static bool is_before_ports(EffectLocation location) {
    return location == EffectLocation::static_transducer || location == EffectLocation::dynamic_transducer ||
           location == EffectLocation::static_line || location == EffectLocation::total_line ||
           location == EffectLocation::pitot;
  }

  /// Quantity that an effect at the location changes and other effects read; count if there is no such
  /// quantity.
  static Quantity source_of(EffectLocation location) {
    switch (location) {
      case EffectLocation::radome:
        return Quantity::radome_dynamic_pressure;
      case EffectLocation::attack_ratio:
        return Quantity::attack_ratio;
      case EffectLocation::attack:
        return Quantity::attack;
      case EffectLocation::sideslip:
        return Quantity::sideslip;
      default:
        return Quantity::count;
    }
  }

  // Coefficients of the laser's beam are excluded: the results do not depend on them.
  void add_coefficients(const std::vector<double>& covariance) {
    const std::size_t count = chain_->parameters().size();
    std::vector<std::size_t> order;
    for (std::size_t number = 0; number < location_count; ++number) {
      const auto location = static_cast<EffectLocation>(number);
      if (location == EffectLocation::beam_elevation || location == EffectLocation::beam_azimuth ||
          location == EffectLocation::beam_speed)
        continue;
      const std::size_t begin = order.size();
      for (std::size_t effect = 0; effect < chain_->effect_count(); ++effect) {
        if (chain_->location_of(effect) != location) continue;
        const std::size_t first = chain_->first_parameter_of(effect);
        const std::size_t next = first + chain_->parameter_count_of(effect);
        for (std::size_t parameter = first; parameter < next; ++parameter) {
          const double variance = covariance[parameter * count + parameter];
          if (!(variance > 0.0)) continue;
          order.push_back(parameter);
          coefficients_.push_back(coefficient(effect, parameter - first, std::sqrt(variance)));
        }
      }
      if (order.size() > begin) terms_by_location_.push_back({location, begin, order.size()});
    }
    for (const std::size_t i : order) {
      for (const std::size_t j : order) covariance_.push_back(covariance[i * count + j]);
    }
  }

  // Squared differences of neighbouring coefficients, including their errors.
  void add_surfaces(const std::vector<double>& covariance) {
    const std::size_t count = chain_->parameters().size();
    for (std::size_t effect = 0; effect < chain_->effect_count(); ++effect) {
      const Surface* const surface = chain_->surface_of(effect);
      if (surface == nullptr) continue;
      const std::size_t first = chain_->first_parameter_of(effect);
      double squares = 0.0;
      double pairs = 0.0;
      const auto add = [&](std::size_t a, std::size_t b) {
        const double difference = chain_->parameters()[a] - chain_->parameters()[b];
        squares += difference * difference + covariance[a * count + a] + covariance[b * count + b] -
                   2.0 * covariance[a * count + b];
        pairs += 1.0;
      };
      const std::size_t columns = surface->axes[1].count;
      for (std::size_t i = 0; i < surface->parameter_count(); ++i) {
        if (i % columns > 0) add(first + i, first + i - 1);
        if (i >= columns) add(first + i, first + i - columns);
      }
      surfaces_.push_back({*surface, std::sqrt(std::max(squares, 0.0) / pairs)});
    }
  }

  Coefficient coefficient(std::size_t effect, std::size_t parameter, double step) const {
    const double* const all = chain_->parameters().data();
    Coefficient made{effect, parameter, chain_->is_linear(effect, parameter), {}, step};
    if (made.is_linear) {
      made.coefficients = chain_->unit_coefficients(effect, parameter, all);
    } else {
      const double* const first = all + chain_->first_parameter_of(effect);
      made.coefficients.assign(first, first + chain_->parameter_count_of(effect));
    }
    return made;
  }

  double shape_of(Coefficient& coefficient, const State<double>& state) const noexcept {
    double* const coefficients = coefficient.coefficients.data();
    if (coefficient.is_linear) return chain_->effect_value(coefficient.effect, state, coefficients);
    const double value = coefficients[coefficient.number];
    coefficients[coefficient.number] = value + coefficient.step;
    const double above = chain_->effect_value(coefficient.effect, state, coefficients);
    coefficients[coefficient.number] = value - coefficient.step;
    const double below = chain_->effect_value(coefficient.effect, state, coefficients);
    coefficients[coefficient.number] = value;
    return (above - below) / (2.0 * coefficient.step);
  }

  // Total of the effects before and at the ports.
  Changes at_ports(const State<double>& state) const noexcept {
    Changes sum;
    const double* const parameters = chain_->parameters().data();
    for (const std::size_t effect : at_ports_) {
      const double value =
          chain_->effect_value(effect, state, parameters + chain_->first_parameter_of(effect));
      add(sum, chain_->location_of(effect), value);
    }
    return sum;
  }

  static void add(Changes& changes, EffectLocation location, double amount) noexcept {
    switch (location) {
      case EffectLocation::static_defect:
        changes.static_defect += amount;
        break;
      case EffectLocation::static_transducer:
        changes.static_pressure += amount;
        break;
      case EffectLocation::static_line:
        changes.static_pressure += amount;
        changes.dynamic_pressure -= amount;
        break;
      case EffectLocation::dynamic_transducer:
      case EffectLocation::total_line:
      case EffectLocation::pitot:
        changes.dynamic_pressure += amount;
        break;
      case EffectLocation::temperature:
        changes.thermometer += amount;
        break;
      case EffectLocation::recovery:
        changes.recovery += amount;
        break;
      case EffectLocation::ambient_temperature:
        changes.calibration += amount;
        break;
      case EffectLocation::humidity:
        changes.vapor += amount;
        break;
      default:
        break;
    }
  }

  // How the effects at the ports answer to a quantity that they read, per unit of it.
  Changes response(const State<double>& state, Quantity quantity, double step) const noexcept {
    State<double> moved = state;
    chain_->change(moved, quantity, step);
    const Changes above = at_ports(moved);
    chain_->change(moved, quantity, -2.0 * step);
    const Changes below = at_ports(moved);
    const double scale = 1.0 / (2.0 * step);
    Changes change;
    change.static_defect = scale * (above.static_defect - below.static_defect);
    change.static_pressure = scale * (above.static_pressure - below.static_pressure);
    change.dynamic_pressure = scale * (above.dynamic_pressure - below.dynamic_pressure);
    return change;
  }

  // Step of the differences: 0.1 of the unit (K, degree or hPa), 0.005 for the attack ratio. Laws are smooth
  // over such a step.
  static double step_of(Quantity quantity) { return quantity == Quantity::attack_ratio ? 0.005 : 0.1; }

  // Uncertainties are reused for less than a second if the pressures have not changed significantly.
  bool still_holds(const State<double>& state) const noexcept {
    const double age = state[Quantity::time] - time_;
    if (!(is_complete_ && age >= 0.0 && age < 0.999) || is_outside_ || is_outside(state)) return false;
    const double p = state[Quantity::static_pressure];
    const double q = state[Quantity::dynamic_pressure];
    return std::abs(p - static_pressure_) <= 0.05 * p && std::abs(q - dynamic_pressure_) <= 0.05 * q;
  }

  bool is_outside(const State<double>& state) const noexcept {
    return std::any_of(surfaces_.begin(), surfaces_.end(),
                       [&state](const FlatOutside& each) { return each.distance(state) > 0.0; });
  }

  void find(const State<double>& state) noexcept {
    time_ = state[Quantity::time];
    is_outside_ = is_outside(state);
    static_pressure_ = state[Quantity::static_pressure];
    dynamic_pressure_ = state[Quantity::dynamic_pressure];
    const Sensitivity sensitivity(*chain_, state);
    const double fraction = chain_->taper_fraction(state);
    Results variance{};
    add_systematic(sensitivity, state, fraction, variance);
    add_random(sensitivity, state, fraction, variance);
    for (std::size_t i = 0; i < found_.size(); ++i) found_[i] = std::sqrt(variance[i]);
    const double of_temperature = chain_->has_temperature() ? found_[3] + found_[4] : 0.0;
    is_complete_ = is_finite(found_[0] + found_[1] + found_[2] + of_temperature);
  }

  // `fraction` is what the taper leaves of the effects at the static ports.
  void add_systematic(const Sensitivity& sensitivity, const State<double>& state, double fraction,
                      Results& variance) noexcept {
    // Effects at the attack ratio read the ratio before them.
    State<double> before = state;
    if (chain_->acts(EffectLocation::attack_ratio) && !is_missing(state[Quantity::attack_ratio]))
      before[Quantity::attack_ratio] =
          state[Quantity::attack_differential_pressure] / state[Quantity::radome_dynamic_pressure];
    for (Coefficient& each : coefficients_) {
      const bool is_at_ratio = chain_->location_of(each.effect) == EffectLocation::attack_ratio;
      each.shape = shape_of(each, is_at_ratio ? before : state);
      // Without a humidity the air counts as dry.
      if (chain_->location_of(each.effect) == EffectLocation::humidity && is_missing(each.shape))
        each.shape = 0.0;
    }
    for (LocationTerms& terms : terms_by_location_)
      terms.by_amount = results_by_amount(sensitivity, state, fraction, terms.location);
    for (const LocationTerms& a : terms_by_location_) {
      for (const LocationTerms& b : terms_by_location_) {
        const double both = shared(a, b);
        for (std::size_t i = 0; i < variance.size(); ++i) {
          // A missing effect is irrelevant to a result that does not depend on it.
          const double slopes = a.by_amount[i] * b.by_amount[i];
          if (slopes != 0.0) variance[i] += slopes * both;
        }
      }
    }
    for (const FlatOutside& each : surfaces_) {
      const double distance = each.distance(state);
      if (!(distance > 0.0)) continue;
      const double error = each.slope * distance * state[Quantity::dynamic_pressure];
      Changes changes;
      changes.static_defect = fraction;
      add_squares(sensitivity.of(changes), error * error, variance);
    }
    // A variance that cancels to zero may round to less.
    for (double& each : variance) each = each < 0.0 ? 0.0 : each;
  }

  // Sensitivity of the results to an amount that is added at the location.
  Results results_by_amount(const Sensitivity& sensitivity, const State<double>& state, double fraction,
                            EffectLocation location) const noexcept {
    const Quantity source = source_of(location);
    Changes changes;
    if (source != Quantity::count) changes = response(state, source, step_of(source));
    add(changes, location, 1.0);
    changes.static_defect *= fraction;
    return sensitivity.of(changes);
  }

  // Covariance of the amounts that are added at two locations, in this sample.
  double shared(const LocationTerms& a, const LocationTerms& b) const noexcept {
    double sum = 0.0;
    for (std::size_t i = a.begin; i < a.end; ++i) {
      const double* const row = covariance_.data() + i * coefficients_.size();
      double part = 0.0;
      for (std::size_t j = b.begin; j < b.end; ++j) part += row[j] * coefficients_[j].shape;
      sum += coefficients_[i].shape * part;
    }
    return sum;
  }

  void add_random(const Sensitivity& sensitivity, const State<double>& state, double fraction,
                  Results& variance) const noexcept {
    for (const Noise& noise : noises_) {
      Changes changes;
      if (noise.moves_law) changes = response(state, noise.role, noise.size);
      changes.static_defect *= fraction;
      if (noise.role == Quantity::dynamic_pressure && fraction < 1.0)
        changes.static_defect += taper_slope(state, noise.size) *
                                 std::max(at_ports(state).static_defect, chain_->minimum_defect());
      add_role(changes, noise.role, state);
      add_squares(sensitivity.of(changes), noise.size * noise.size, variance);
    }
    for (const RateNoise& noise : rate_noises_) add_rate(noise, sensitivity, state, fraction, variance);
    const double ratio = static_defect_ratio_ * state[Quantity::static_pressure];
    const double left = static_defect_ * static_defect_ + ratio * ratio;
    if (static_defect_ == 0.0 && static_defect_ratio_ == 0.0) return;
    Changes changes;
    changes.static_defect = 1.0;
    add_squares(sensitivity.of(changes), left, variance);
  }

  // Derivative of the remaining fraction of delta-p with respect to the dynamic pressure, 1/hPa.
  double taper_slope(State<double> state, double step) const noexcept {
    state[Quantity::dynamic_pressure] += step;
    const double above = chain_->taper_fraction(state);
    state[Quantity::dynamic_pressure] -= 2.0 * step;
    return (above - chain_->taper_fraction(state)) / (2.0 * step);
  }

  // The filter of a derivative has no weight at its own sample, so this noise is independent of the direct
  // noise of the quantity.
  void add_rate(const RateNoise& noise, const Sensitivity& sensitivity, State<double> state, double fraction,
                Results& variance) const noexcept {
    Results change{};
    const double before = state[noise.rate];
    for (const std::size_t effect : noise.effects) {
      const double* const parameters = chain_->parameters().data() + chain_->first_parameter_of(effect);
      state[noise.rate] = before + noise.size;
      const double above = chain_->effect_value(effect, state, parameters);
      state[noise.rate] = before - noise.size;
      const double by_noise = 0.5 * (above - chain_->effect_value(effect, state, parameters));
      state[noise.rate] = before;
      if (by_noise == 0.0) continue;
      const Results by_amount = results_by_amount(sensitivity, state, fraction, chain_->location_of(effect));
      for (std::size_t i = 0; i < change.size(); ++i) {
        // A missing rate is irrelevant to a result that does not depend on it.
        if (by_amount[i] != 0.0) change[i] += by_amount[i] * by_noise;
      }
    }
    add_squares(change, 1.0, variance);
  }

  static void add_squares(const Results& results, double square, Results& variance) noexcept {
    for (std::size_t i = 0; i < variance.size(); ++i) variance[i] += results[i] * results[i] * square;
  }

  // Change of the inputs of the air for a unit of the role.
  static void add_role(Changes& changes, Quantity role, const State<double>& state) noexcept {
    // Magnus: d(ln e)/dT = 17.62 * 243.12/(243.12 + t)^2 over water, within 5 % over ice.
    const auto by_point = [&](double point) {
      if (is_missing(point)) return 0.0;  // then the air counts as dry
      const double width = point - 30.03;
      const double p = state[Quantity::corrected_static_pressure];
      return 4284.0 / (width * width) * state[Quantity::humidity] * p;
    };
    switch (role) {
      case Quantity::static_pressure:
        changes.static_pressure += 1.0;
        break;
      case Quantity::dynamic_pressure:
        changes.dynamic_pressure += 1.0;
        break;
      case Quantity::recovery_temperature:
        changes.thermometer += 1.0;
        break;
      case Quantity::ambient_temperature:
        changes.ambient += 1.0;
        break;
      case Quantity::vapor_pressure:
        changes.vapor += 1.0;
        break;
      case Quantity::dew_point:
      case Quantity::frost_point:
        changes.vapor += by_point(state[role]);
        break;
      default:
        break;
    }
  }

  std::shared_ptr<const Chain> chain_;
  double static_defect_;
  double static_defect_ratio_;
  std::vector<std::size_t> at_ports_;  // effects before and at them
  std::vector<Coefficient> coefficients_;
  std::vector<LocationTerms> terms_by_location_;
  std::vector<double> covariance_;  // covariance of the coefficients, in their order
  std::vector<FlatOutside> surfaces_;
  std::vector<Noise> noises_;
  std::vector<RateNoise> rate_noises_;
  Results found_{};
  bool is_complete_ = false;  // all are finite
  bool is_outside_ = false;   // computed outside the envelope of a surface
  double time_ = 0.0;         // time of the sample for which they were computed
  double static_pressure_ = 0.0;
  double dynamic_pressure_ = 0.0;
};

}  // namespace pcor
