#include <pcor/improve/improve.hpp>
#include <pcor/roles/add_effects.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "campaign/gps_rows.hpp"
#include "fit/lineage.hpp"
#include "improve/improve_loop.hpp"
#include "improve/model_trials.hpp"

namespace pcor {

using namespace internal;

namespace {

/// Variables present in all flights.
std::vector<std::string> common_variables(const FlightSet& flights) {
  const std::vector<std::vector<std::string>> of_each = flights.variables();
  std::vector<std::string> common;
  for (const std::vector<std::string>& variables : of_each) {
    if (&variables == &of_each.front()) common = variables;
    const std::set<std::string> here(variables.begin(), variables.end());
    common.erase(std::remove_if(common.begin(), common.end(),
                                [&here](const std::string& name) { return here.count(name) == 0; }),
                 common.end());
  }
  return common;
}

/// Fixes parameters of the last effect that its flights cannot separate from others.
void hold(ModelDefinition& file, const std::vector<std::string>& parameters) {
  const std::vector<std::string> names = parameter_names(file.model.effects.back());
  file.fits.resize(file.model.effects.size());
  EffectFit& fit = file.fits.back();
  fit.resize(names.size());
  for (std::size_t p = 0; p < names.size(); ++p) {
    if (std::find(parameters.begin(), parameters.end(), names[p]) != parameters.end()) fit[p].fixed = true;
  }
}

}  // namespace

std::string_view to_string(StopReason reason) {
  switch (reason) {
    case StopReason::nothing_missing:
      return "nothing missing";
    case StopReason::reference_system:
      return "reference system";
    case StopReason::in_model:
      return "in model";
    case StopReason::unexplained:
      return "unexplained";
    case StopReason::no_gain:
      return "no gain";
    case StopReason::max_steps:
      return "max steps";
  }
  return "";
}

std::string rivals_text(const ImproveStep& step) {
  if (step.rivals.empty()) return "";
  std::vector<std::string> each;
  for (const StepRival& rival : step.rivals) {
    each.push_back(fmt::format("{} (probability {:.2f}, changes it by {:.3f} hPa)", rival.effect,
                               rival.probability, rival.static_change));
  }
  return fmt::format(
      "its rivals imply different corrected static pressures: {}; {}, and the expected error of this choice, "
      "{:.3f} hPa, is included in the stated error",
      fmt::join(each, ", "),
      step.delivered.empty() ? "no rival was added, since each would increase the error under another"
                             : "the model has " + step.delivered,
      step.rival_error);
}

Improvement improve(const FlightSet& flights, const ModelDefinition& model, const References& references,
                    const ImproveOptions& options) {
  const FlightSet all = flights.with(options.refit.holdout);
  const std::vector<std::string> variables = common_variables(all);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < flights.size(); ++i) names.push_back(flights.name(i));
  const auto tell = [&options](const std::string& what) {
    if (options.progress) options.progress(what);
  };
  const auto last_of = [&model](const ModelDefinition& file) {
    return file.model.effects.size() == model.model.effects.size() ? std::string("the given model")
                                                                   : file.model.effects.back().id;
  };
  const auto added_to = [&model](const ModelDefinition& file) {
    std::vector<std::string> added;
    for (std::size_t e = model.model.effects.size(); e < file.model.effects.size(); ++e)
      added.push_back(file.model.effects[e].id);
    return added;
  };
  const auto refit_options_for = [&](const TrialModel& trial) {
    RefitOptions refit_with = options.refit;
    refit_with.alike = trial.alike;
    refit_with.added = added_to(trial.file);
    return refit_with;
  };
  // References of single samples come first, as in the diagnosis: figures refer to the first.
  References ordered = references;
  std::stable_partition(ordered.begin(), ordered.end(),
                        [](const auto& reference) { return reference->is_of_one_sample(); });
  DiagnoseOptions diagnose_with;
  diagnose_with.mask = options.refit.mask;
  diagnose_with.formulas = options.formulas;
  diagnose_with.training_share = options.refit.training_share;
  diagnose_with.trust_reference = options.refit.trust_reference;
  diagnose_with.progress = options.refit.progress;

  ImproveLoop loop;
  loop.is_by_gps = gps_kind(first_of(ordered)).has_value();
  loop.refit = [&](const TrialModel& trial) {
    tell("fitting with " + last_of(trial.file));
    const RefitOptions refit_with = refit_options_for(trial);
    if (!gps_kind(first_of(ordered))) return refit(flights, trial.file, ordered, refit_with);
    return refit(flights, with_start_of(model, trial.file), ordered, refit_with);
  };
  loop.diagnose = [&](const TrialModel& trial) {
    tell("diagnosing with " + last_of(trial.file));
    diagnose_with.added = added_to(trial.file);
    Diagnosis diagnosis = diagnose(flights, trial.file, with_alike(ordered, trial, variables), diagnose_with);
    if (!diagnose_with.series_of)  // pictures of all steps show the same flights
      diagnose_with.series_of = diagnosis.flights_with_records();
    return diagnosis;
  };
  loop.add = [&](const TrialModel& trial, const AddedEffect& added) {
    TrialModel extended{add_effects(trial.file, {added.effect}, variables), trial.alike};
    hold(extended.file, added.held);
    if (added.is_alike) extended.alike.push_back(added.effect.id);
    return extended;
  };
  loop.try_models = [&](const std::vector<TrialModel>& models) {
    return try_models(flights, models, ordered, options.refit);
  };
  loop.offer_surface = [&](const TrialModel& trial) {
    tell("testing a surface with " + last_of(trial.file));
    return offer_surface(flights, trial, ordered, refit_options_for(trial));
  };
  loop.has_holdout = !options.refit.holdout.empty() || options.refit.training_share < 1.0;
  loop.trace_variables = options.trace_variables;
  loop.max_steps = options.max_steps;
  loop.flights = fmt::format("{}", fmt::join(names, ", "));
  Improvement improvement = loop.run(model);
  all.require_unchanged();
  const bool has_added = improvement.model.model.effects.size() > model.model.effects.size();
  descend(improvement.model, model, has_added ? "improved on" : "fitted to", flights.title());
  return improvement;
}

}  // namespace pcor
