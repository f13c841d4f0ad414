#include <pcor/improve/improve.hpp>
#include <pcor/roles/add_effects.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "campaign/gps_rows.hpp"
#include "fit/fitted_model.hpp"
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

DiagnoseOptions diagnose_options_of(const ImproveOptions& options) {
  DiagnoseOptions diagnose_with;
  diagnose_with.mask = options.refit.mask;
  diagnose_with.formulas = options.formulas;
  diagnose_with.training_share = options.refit.training_share;
  diagnose_with.trust_reference = options.refit.trust_reference;
  return diagnose_with;
}

}  // namespace

std::string_view to_string(StopReason reason) {
  constexpr std::array<std::string_view, 6> names{"nothing missing", "reference system", "in model",
                                                  "unexplained",     "no gain",          "max steps"};
  return names.at(static_cast<std::size_t>(reason));
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
  const auto added_to = [&model](const ModelDefinition& file) {
    std::vector<std::string> added;
    for (std::size_t e = model.model.effects.size(); e < file.model.effects.size(); ++e)
      added.push_back(file.model.effects[e].id);
    return added;
  };
  const auto tell = [&](const char* what, const ModelDefinition& file) {
    const std::vector<std::string> added = added_to(file);
    if (options.progress)
      options.progress(fmt::format("{} with {}", what, added.empty() ? "the input model" : added.back()));
  };
  const auto refit_options_for = [&](const TrialModel& trial) {
    RefitOptions refit_with = options.refit;
    refit_with.shared_effects = trial.shared_effects;
    refit_with.added = added_to(trial.file);
    return refit_with;
  };
  // References of single samples come first, as in the diagnosis: figures refer to the first.
  References ordered = references;
  std::stable_partition(ordered.begin(), ordered.end(),
                        [](const auto& reference) { return reference->is_of_one_sample(); });
  DiagnoseOptions diagnose_with = diagnose_options_of(options);
  diagnose_with.progress = options.refit.progress;

  ImproveLoop loop;
  loop.is_by_gps = gps_kind(first_of(ordered)).has_value();
  loop.refit = [&](const TrialModel& trial) {
    tell("fitting", trial.file);
    return refit(flights, loop.is_by_gps ? with_start_of(model, trial.file) : trial.file, ordered,
                 refit_options_for(trial));
  };
  loop.diagnose = [&](const TrialModel& trial) {
    tell("diagnosing", trial.file);
    Diagnosis diagnosis = diagnose(flights, trial.file,
                                   references_with_shared_effects(ordered, trial, variables), diagnose_with);
    if (!diagnose_with.series_of)  // pictures of all steps show the same flights
      diagnose_with.series_of = diagnosis.flights_with_records();
    return diagnosis;
  };
  loop.add = [&](const TrialModel& trial, const AddedEffect& added) {
    TrialModel extended{add_effects(trial.file, {added.effect}, variables), trial.shared_effects};
    const std::vector<std::string> names_of_parameters = parameter_names(added.effect);
    for (std::size_t p = 0; p < names_of_parameters.size(); ++p) {
      // The flights cannot separate a held parameter from others.
      if (std::count(added.fixed.begin(), added.fixed.end(), names_of_parameters[p]) > 0)
        extended.file.fits.back()[p].fixed = true;
    }
    if (added.is_shared) extended.shared_effects.push_back(added.effect.id);
    return extended;
  };
  loop.try_models = [&](const std::vector<TrialModel>& models) {
    return try_models(flights, models, ordered, options.refit);
  };
  // Wind and heights do not determine a surface.
  if (!loop.is_by_gps) {
    loop.offer_surface = [&](const TrialModel& trial) {
      tell("testing a surface", trial.file);
      return offer_surface(flights, trial, ordered, refit_options_for(trial));
    };
  }
  loop.has_holdout = !options.refit.holdout.empty() || options.refit.training_share < 1.0;
  loop.trace_variables = options.trace_variables;
  loop.max_steps = options.max_steps;
  loop.flights = fmt::format("{}", fmt::join(names, ", "));
  Improvement improvement = loop.run(model);
  all.require_unchanged();
  const bool has_added = improvement.model.model.effects.size() > model.model.effects.size();
  record_provenance(improvement.model, model, has_added ? "improved on" : "fitted to", flights.title());
  return improvement;
}

const Finding* finding_of(const Improvement& improvement, std::size_t step) {
  for (const Finding& finding : improvement.steps[step - 1].diagnosis.findings) {
    if (finding.id() == improvement.steps[step].added) return &finding;
  }
  return nullptr;
}

WhatIf what_if(const FlightSet& flights, const Improvement& improvement, const References& references,
               const ImproveOptions& options) {
  WhatIfOptions with;
  with.diagnose = diagnose_options_of(options);
  with.diagnose.series_of = improvement.steps.front().diagnosis.flights_with_records();
  with.holdout = options.refit.holdout;
  with.is_robust = options.refit.loss != Loss::none;
  std::vector<WhatIfCandidate> candidates;
  std::vector<WhatIfCandidate> rivals;
  for (std::size_t index = 1; index < improvement.steps.size(); ++index) {
    const ImproveStep& step = improvement.steps[index];
    WhatIfCandidate candidate{step.added, fmt::format("step {}", index), {}, false, step.added};
    for (const ModelEffect& effect : improvement.fit.model.model.effects) {
      if (effect.id == step.added) candidate.effect = effect;
    }
    // A surface has no single coefficient to move.
    if (candidate.effect && candidate.effect->is_surface()) continue;
    if (const Finding* const finding = finding_of(improvement, index)) {
      candidate.is_shared = finding->is_shared;
      for (const Alias& alias : finding->aliases)
        rivals.push_back(
            {alias.effect, "instead of " + step.added, alias.correction, alias.is_shared, step.added});
    }
    candidates.push_back(std::move(candidate));
  }
  for (WhatIfCandidate& candidate : what_if_candidates(improvement.steps.back().diagnosis, options.formulas))
    rivals.push_back(std::move(candidate));
  for (WhatIfCandidate& rival : rivals) {
    const bool is_new = std::none_of(candidates.begin(), candidates.end(),
                                     [&rival](const WhatIfCandidate& each) { return each.id == rival.id; });
    if (is_new && candidates.size() < max_what_if_effects) candidates.push_back(std::move(rival));
  }
  WhatIf tried = what_if(flights, improvement.refitted, references, candidates, with);
  tried.panel.start = "refitted";
  if (tried.panel.held_out.samples > 0.0) tried.panel.is_start_fitted = false;
  return tried;
}

}  // namespace pcor
