#include "improve/model_trials.hpp"

#include <algorithm>
#include <cmath>

#include <pcor/effects/catalogue.hpp>
#include <pcor/roles/add_effects.hpp>
#include "campaign/linear_rows.hpp"
#include "diagnose/rms.hpp"
#include "parallel/flight_partition.hpp"
#include "residuals/flight_statistics.hpp"
#include "residuals/serialization.hpp"

namespace pcor::internal {
namespace {

/// Effect of a model; null if the model lacks it.
const ModelEffect* effect_in(const ModelDefinition& model, const std::string& id) {
  const std::vector<ModelEffect>& effects = model.model.effects;
  const auto found =
      std::find_if(effects.begin(), effects.end(), [&id](const ModelEffect& each) { return each.id == id; });
  return found == effects.end() ? nullptr : &*found;
}

/// Coefficients that disable an effect, in its shape.
std::vector<double> neutral_of(const ModelEffect& effect) {
  std::vector<double> parameters(effect.parameters.size(), 0.0);
  if (effect.is_formula()) return parameters;
  parameters = neutral_effect(effect.id).parameters;
  const EffectInfo& info = *effect_named(effect.id);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (info.parameters[i].shape) parameters[i] = effect.parameters[i];
  }
  return parameters;
}

/// Model of another system with the shared effects at the coefficients of this model.
ModelDefinition add_shared_effects(ModelDefinition other, const TrialModel& model,
                                   const std::vector<std::string>& variables) {
  for (const std::string& id : model.shared_effects) {
    const ModelEffect& shared = *effect_in(model.file, id);
    if (!has_effect(other, id)) other = add_effects(other, {shared}, variables);
    for (ModelEffect& effect : other.model.effects) {
      if (effect.id == id) effect.parameters = shared.parameters;
    }
  }
  return other;
}

/// Model without the shared effects: they cancel in comparisons of two systems.
ModelDefinition without_shared_effects(ModelDefinition file, const TrialModel& model) {
  std::vector<ModelEffect>& effects = file.model.effects;
  const auto is_shared = [&model](const ModelEffect& effect) {
    return std::find(model.shared_effects.begin(), model.shared_effects.end(), effect.id) !=
           model.shared_effects.end();
  };
  effects.erase(std::remove_if(effects.begin(), effects.end(), is_shared), effects.end());
  return file;
}

}  // namespace

ModelDefinition union_of(const std::vector<TrialModel>& models) {
  ModelDefinition whole = models.front().file;
  whole.fits.resize(whole.model.effects.size());
  for (const auto& [model, shared_effects] : models) {
    for (std::size_t e = 0; e < model.model.effects.size(); ++e) {
      const ModelEffect& effect = model.model.effects[e];
      if (has_effect(whole, effect.id)) continue;
      whole.model.effects.push_back(effect);
      whole.fits.push_back(e < model.fits.size() ? model.fits[e] : EffectFit{});
    }
    whole.variables.insert(model.variables.begin(), model.variables.end());
    whole.units.insert(model.units.begin(), model.units.end());
  }
  return whole;
}

std::vector<double> coefficients_in(const ModelDefinition& model, const ModelDefinition& whole) {
  std::vector<double> coefficients;
  for (const ModelEffect& effect : whole.model.effects) {
    const ModelEffect* const found = effect_in(model, effect.id);
    const std::vector<double> parameters = found == nullptr ? neutral_of(effect) : found->parameters;
    coefficients.insert(coefficients.end(), parameters.begin(), parameters.end());
  }
  return coefficients;
}

ModelDefinition with_start_of(const ModelDefinition& given, ModelDefinition extended) {
  extended.covariance = given.covariance;
  extended.fits.resize(extended.model.effects.size());
  for (std::size_t e = 0; e < extended.model.effects.size(); ++e) {
    ModelEffect& effect = extended.model.effects[e];
    if (e < given.model.effects.size()) {
      effect.parameters = given.model.effects[e].parameters;
      extended.fits[e] = e < given.fits.size() ? given.fits[e] : EffectFit{};
      continue;
    }
    if (!effect.is_formula()) effect.parameters = neutral_of(effect);
    for (ParameterFit& parameter : extended.fits[e]) parameter.standard_error.reset();
  }
  return extended;
}

References references_with_shared_effects(const References& references, const TrialModel& model,
                                          const std::vector<std::string>& variables) {
  if (model.shared_effects.empty()) return references;
  References result;
  for (const std::shared_ptr<const Reference>& reference : references) {
    const ModelDefinition* const other = reference->model();
    result.push_back(other == nullptr ? reference
                                      : reference->with_model(add_shared_effects(*other, model, variables)));
  }
  return result;
}

std::vector<TrialFlight> try_models(const FlightSet& flights, const std::vector<TrialModel>& models,
                                    const References& references, const RefitOptions& options) {
  const ModelDefinition whole = union_of(models);
  std::vector<TrialFlight> tried;
  for (const std::shared_ptr<const Reference>& reference : references) {
    std::vector<std::vector<double>> trials;  // all residual coefficients of each model
    for (const TrialModel& model : models) {
      std::vector<double>& all = trials.emplace_back();
      const ModelDefinition* const other = reference->model();
      all = coefficients_in(other == nullptr ? model.file : without_shared_effects(model.file, model), whole);
      if (other == nullptr) continue;
      const std::vector<double> theirs = coefficients_in(without_shared_effects(*other, model), *other);
      all.insert(all.end(), theirs.begin(), theirs.end());
    }
    const auto add = [&](const FlightSet& some, double training_share) {
      const auto tried_on = [&](std::size_t number) {
        TrialFlight flight;
        flight.samples = some.samples(number, whole, *reference, options.mask);
        const LinearRows rows(Residuals(flight.samples, whole, *reference, options.mask), whole, *reference,
                              {Inputs::none, {}, training_share});
        flight.fitted = rows.used();
        flight.held_out = rows.held_out();
        for (const std::vector<double>& coefficients : trials) {
          flight.residuals.push_back(rows.residuals().values(coefficients.data()));
          flight.static_pressures.push_back(
              rows.residuals().quantity(Quantity::corrected_static_pressure, coefficients.data()));
        }
        return flight;
      };
      for (TrialFlight& flight : some.partition().all_gather_flights<TrialFlight>(tried_on)) {
        flight.first_reference = reference == references.front();
        flight.window = reference->window();
        tried.push_back(std::move(flight));
      }
    };
    add(flights, options.training_share);
    add(options.holdout, 0.0);
  }
  return tried;
}

bool TrialComparison::is_better() const {
  return chi2_reduction > sure_gain * chi2_reduction_error ||
         (!is_worse() && first_chi2_reduction > sure_gain * first_chi2_reduction_error);
}
bool TrialComparison::is_worse() const { return chi2_reduction < -sure_gain * chi2_reduction_error; }

TrialComparison comparison_of(const std::vector<TrialFlight>& flights, std::size_t before, std::size_t after,
                              bool held_out) {
  TrialComparison result;
  SquareSum before_sum;
  SquareSum after_sum;
  double variance = 0.0;
  double first_variance = 0.0;
  for (const TrialFlight& flight : flights) {
    const std::vector<std::size_t>& part = held_out ? flight.held_out : flight.fitted;
    if (part.empty()) continue;
    const std::vector<double> was = select_samples(flight.residuals[before], part);
    const std::vector<double> is = select_samples(flight.residuals[after], part);
    const Estimate gain =
        gain_between(*flight.samples, was, is, noise_of_flight(*flight.samples, is), flight.window);
    result.chi2_reduction += gain.value;
    variance += gain.error * gain.error;
    if (!flight.first_reference) continue;
    result.first_chi2_reduction += gain.value;
    first_variance += gain.error * gain.error;
    for (const std::size_t i : part) {
      if (std::isnan(was[i]) || std::isnan(is[i])) continue;
      before_sum.add(was[i]);
      after_sum.add(is[i]);
    }
  }
  result.chi2_reduction_error = std::sqrt(variance);
  result.first_chi2_reduction_error = std::sqrt(first_variance);
  result.rms_before = before_sum.rms();
  result.rms_after = after_sum.rms();
  return result;
}

std::vector<double> static_changes_of(const std::vector<TrialFlight>& flights, std::size_t before,
                                      std::size_t after) {
  std::vector<double> changes;
  for (const TrialFlight& flight : flights) {
    if (!flight.first_reference) continue;
    for (const std::size_t i : flight.fitted)
      changes.push_back(flight.static_pressures[after][i] - flight.static_pressures[before][i]);
  }
  return changes;
}

}  // namespace pcor::internal
