#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
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
/// sample, by the law of propagation (GUM 5.1.3, note 2):
///
///     u^2 = sum_i ((y(x + u_i) - y(x - u_i)) / 2)^2
///
/// with y the results of the chain and u_i independent changes of one standard uncertainty: the vectors of
/// the root of the coefficients' covariance, the noise of each role, of each rate of change (for lags), the
/// surfaces outside their envelope, and the remaining error of the law. Curvature cancels in the
/// difference; a limit, as of saturated air, counts in the proportion in which the error reaches it. Where
/// one side has no result, the difference is that of the other side. Where neither side has a result, as for
/// flow angles at a radome pressure below its noise, the uncertainty is missing, with the bit
/// `outside_domain`.
///
/// All u_i that change only effects at the static ports act through the sum of these effects: they are one
/// change of this sum by its standard uncertainty. Outside its envelope a surface is flat, and its error
/// grows by the rms slope inside the envelope. docs/uncertainty.md lists the contributions.
///
/// Cost: two runs of the chain for this change and for each other u_i; two sums for each u_i at the ports.
///
/// If delta-p is raised to the minimum of the model, it keeps the uncertainty of the model. If it is tapered,
/// the contributions of coefficients and inputs are tapered, too; the model's own uncertainty of delta-p is
/// not. If a result is missing, its uncertainty is missing. Outside the domain of the law all uncertainties
/// are missing, because the law was not fitted there. If LAMS corrects the sample, only the uncertainty of
/// the model's delta-p is given, because the model covariance does not apply to the laser.
class ResultUncertainty final : public Functor {
 public:
  /// nullptr if `uncertainty` does not match the model of `chain`, with the reason in `error`.
  /// @param look_ahead of the rates of change that effects read, for their noise; nullptr without such
  /// effects
  static std::unique_ptr<ResultUncertainty> build(const Chain& chain, const ModelUncertainty& uncertainty,
                                                  CorrectWith with, std::string* error,
                                                  const LookAhead* look_ahead = nullptr) {
    const auto fail = [error](std::string why) {
      if (error != nullptr) *error = std::move(why);
      return nullptr;
    };
    Chain calibrated = chain;
    for (const ModelEffect& effect : uncertainty.calibration) {
      BindingError why;
      std::optional<Chain> extended = calibrated.with_effect(effect, &why);
      if (!extended) return fail(why.message());
      calibrated = std::move(*extended);
    }
    const auto is_size = [](double value) { return is_finite(value) && value >= 0.0; };
    if (!is_size(uncertainty.static_defect) || !is_size(uncertainty.static_defect_ratio) ||
        !std::all_of(uncertainty.random.begin(), uncertainty.random.end(), is_size)) {
      return fail("a standard uncertainty is negative or not finite; give zero or a positive number");
    }
    std::vector<std::vector<double>> root;
    if (!uncertainty.covariance.empty()) {
      const std::size_t count = calibrated.parameters().size();
      if (uncertainty.covariance.size() != count * count) {
        return fail("the covariance is not of this model, which has " + std::to_string(count) +
                    " parameter(s)");
      }
      auto found = covariance_root(uncertainty.covariance, count);
      if (!found) return fail("the covariance of the model's parameters gives a negative variance");
      root = std::move(*found);
    }
    auto made = std::unique_ptr<ResultUncertainty>(new ResultUncertainty(
        reads(chain, with), std::move(calibrated), std::move(root), uncertainty, look_ahead));
    for (const Quantity quantity : MeasuredQuantities::writes_in_place(chain))
      made->recorded_.emplace_back(quantity, missing<double>());
    return made;
  }

  /// Keeps the recorded values that the chain modifies in place. Call it before the chain runs.
  void keep_recorded(const State<double>& state) noexcept {
    for (auto& [quantity, value] : recorded_) value = state[quantity];
  }

  void compute(State<double>& state, QualityFlags& flags) noexcept override {
    inputs_ = state;
    for (const auto& [quantity, value] : recorded_) inputs_[quantity] = value;
    const std::vector<double>& parameters = chain_.parameters();
    // The policy raises delta-p to its minimum by this amount. It is kept, so that delta-p keeps the
    // uncertainty of the law.
    const double at_ports = chain_.sum_at_ports(state, parameters.data());
    const double raised = std::max(0.0, chain_.minimum_defect() - at_ports);
    at_ports_ = raised;
    results_ = results();
    // The product makes the uncertainty missing if the result is missing, and outside the domain of the law.
    const double zero = chain_.is_outside_domain(state) ? missing<double>() : 0.0;
    for (std::size_t i = 0; i < variances_.size(); ++i)
      variances_[i] = zero * state[uncertain_results[i].result];
    const auto move = [&](const std::vector<double>& change, double sign) {
      for (std::size_t i = 0; i < change.size(); ++i) parameters_[i] = parameters[i] + sign * change[i];
    };
    for (const std::vector<double>& change : root_) add([&](double sign) { move(change, sign); });
    double variance_at_ports = 0.0;
    for (const std::vector<double>& change : root_at_ports_) {
      move(change, 1.0);
      const double above = chain_.sum_at_ports(state, parameters_.data());
      move(change, -1.0);
      const double below = chain_.sum_at_ports(state, parameters_.data());
      const double difference = half_difference(above, at_ports, below);
      variance_at_ports += difference * difference;
    }
    std::copy(parameters.begin(), parameters.end(), parameters_.begin());
    for (const Noise& noise : noises_) {
      const double value = inputs_[noise.quantity];
      add([&](double sign) { inputs_[noise.quantity] = value + sign * noise.size; });
    }
    for (const FlatOutside& each : surfaces_) {
      const double error = each.slope * each.distance(state) * state[Quantity::dynamic_pressure];
      if (error > 0.0) variance_at_ports += error * error;
    }
    if (!(variance_at_ports <= 0.0)) {
      const double error = std::sqrt(variance_at_ports);
      add([&](double sign) { at_ports_ = raised + sign * error; });
    }
    const double remaining =
        std::hypot(static_defect_, static_defect_ratio_ * state[Quantity::static_pressure]);
    if (remaining > 0.0) add([&](double sign) { after_law_ = sign * remaining; });
    for (std::size_t i = 0; i < variances_.size(); ++i) {
      // A temperature of the host is not a result.
      const bool is_result =
          i == 0 || (!flags.has(Quality::corrected_with_lams) && (i < 3 || chain_.has_temperature()));
      const double uncertainty = is_result ? std::sqrt(variances_[i]) : missing<double>();
      state[uncertain_results[i].uncertainty] = uncertainty;
      flags.set(is_result && is_missing(uncertainty) && !is_missing(state[uncertain_results[i].result]),
                Quality::outside_domain);
    }
  }

 private:
  /// One value for each of `uncertain_results`.
  using Results = std::array<double, uncertain_results.size()>;

  /// Error of a surface outside its envelope, where the surface is constant but the true coefficient may vary
  /// as inside.
  struct FlatOutside {
    Surface surface;
    double slope;  // rms difference of neighbouring coefficients

    double distance(const State<double>& state) const {
      return surface.distance(state[surface.axes[0].quantity], state[surface.axes[1].quantity]);
    }
  };

  /// A role, or a rate of change, whose value is uncertain in every sample.
  struct Noise {
    Quantity quantity;
    double size;
  };

  ResultUncertainty(Quantities inputs, Chain chain, std::vector<std::vector<double>> root,
                    const ModelUncertainty& uncertainty, const LookAhead* look_ahead)
      : Functor(std::move(inputs), writes()),
        chain_(std::move(chain)),
        static_defect_(uncertainty.static_defect),
        static_defect_ratio_(uncertainty.static_defect_ratio),
        parameters_(chain_.parameters()) {
    for (std::vector<double>& change : root)
      (is_at_ports(change) ? root_at_ports_ : root_).push_back(std::move(change));
    if (!uncertainty.covariance.empty()) add_surfaces(uncertainty.covariance);
    for (std::size_t i = 0; i < role_count; ++i) {
      const auto role = static_cast<Quantity>(i);
      if (chain_.recorded(role)) add_noise(role, uncertainty.random[i]);
    }
    if (look_ahead == nullptr) return;
    // The filter of a derivative has no weight at its own sample, so its noise is independent of the direct
    // noise of the quantity.
    for (const Rate& each : rates)
      add_noise(each.rate, look_ahead->noise_of(each.rate) * uncertainty.random[index(each.quantity)]);
  }

  void add_noise(Quantity quantity, double size) {
    if (size > 0.0) noises_.push_back({quantity, size});
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

  // Whether a change of the parameters changes effects at the static ports alone.
  bool is_at_ports(const std::vector<double>& change) const {
    std::vector<bool> is_elsewhere(change.size(), true);
    for (std::size_t effect = 0; effect < chain_.effect_count(); ++effect) {
      if (chain_.location_of(effect) != EffectLocation::static_defect) continue;
      for (std::size_t i = 0; i < chain_.parameter_count_of(effect); ++i)
        is_elsewhere[chain_.first_parameter_of(effect) + i] = false;
    }
    for (std::size_t i = 0; i < change.size(); ++i) {
      if (is_elsewhere[i] && change[i] != 0.0) return false;
    }
    return true;
  }

  // Squared differences of neighbouring coefficients, including their errors.
  void add_surfaces(const std::vector<double>& covariance) {
    const std::size_t count = chain_.parameters().size();
    for (std::size_t effect = 0; effect < chain_.effect_count(); ++effect) {
      const Surface* const surface = chain_.surface_of(effect);
      if (surface == nullptr) continue;
      const std::size_t first = chain_.first_parameter_of(effect);
      double squares = 0.0;
      double pairs = 0.0;
      const auto add = [&](std::size_t a, std::size_t b) {
        const double difference = chain_.parameters()[a] - chain_.parameters()[b];
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

  // Adds the variance by one error. `move` sets it to a number of its standard uncertainties.
  template <class Move>
  void add(const Move& move) noexcept {
    move(1.0);
    const Results above = results();
    move(-1.0);
    const Results below = results();
    move(0.0);
    for (std::size_t i = 0; i < variances_.size(); ++i) {
      const double difference = half_difference(above[i], results_[i], below[i]);
      variances_[i] += difference * difference;
    }
  }

  static double half_difference(double above, double middle, double below) noexcept {
    return is_missing(above) ? middle - below : is_missing(below) ? above - middle : 0.5 * (above - below);
  }

  // Results of the chain for the present inputs, parameters and amounts.
  Results results() const noexcept {
    NoQualityFlags flags;
    State<double> state = inputs_;
    const double* const parameters = parameters_.data();
    chain_.correct_inputs(state, parameters, flags);
    const double at_ports = chain_.sum_at_ports(state, parameters) + at_ports_;
    state[Quantity::static_defect] = at_ports * chain_.taper_fraction(state) + after_law_;
    chain_.correct(state, state[Quantity::static_defect], flags);
    chain_.air(state, parameters, flags);
    Results found{};
    for (std::size_t i = 0; i < found.size(); ++i) found[i] = state[uncertain_results[i].result];
    return found;
  }

  Chain chain_;                              // model with the calibrations of the uncertainty
  std::vector<std::vector<double>> root_{};  // changes of the parameters
  std::vector<std::vector<double>> root_at_ports_{};
  double static_defect_;
  double static_defect_ratio_;
  std::vector<FlatOutside> surfaces_;
  std::vector<Noise> noises_;
  std::vector<std::pair<Quantity, double>> recorded_;  // before the chain modifies them in place
  State<double> inputs_;
  std::vector<double> parameters_;
  double at_ports_ = 0.0;   // added to the effects at the static ports, hPa
  double after_law_ = 0.0;  // added to delta-p, hPa
  Results results_{};       // results without changes
  Results variances_{};
};

}  // namespace pcor
