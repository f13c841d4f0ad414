#include <pcor/improve/improve.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace pcor {
namespace {

/// Effect of the best model that a step added; empty if that model lacks it.
std::optional<ModelEffect> effect_of(const Improvement& improvement, const ImproveStep& step) {
  for (const ModelEffect& effect : improvement.fit.model.model.effects) {
    if (effect.id == step.added) return effect;
  }
  return std::nullopt;
}

/// Finding before a step; null if there is no finding.
const Finding* finding_of(const Improvement& improvement, std::size_t index) {
  const std::vector<Finding>& findings = improvement.steps[index - 1].diagnosis.findings;
  const auto found = std::find_if(findings.begin(), findings.end(), [&](const Finding& finding) {
    return finding.id() == improvement.steps[index].added;
  });
  return found == findings.end() ? nullptr : &*found;
}

}  // namespace

WhatIf what_if(const FlightSet& flights, const Improvement& improvement, const References& references,
               const ImproveOptions& options) {
  WhatIfOptions with;
  with.diagnose.mask = options.refit.mask;
  with.diagnose.series_of = improvement.steps.front().diagnosis.flights_with_records();
  with.diagnose.training_share = options.refit.training_share;
  with.diagnose.formulas = options.formulas;
  with.diagnose.trust_reference = options.refit.trust_reference;
  with.holdout = options.refit.holdout;
  with.is_robust = options.refit.loss != Loss::none;
  std::vector<WhatIfCandidate> candidates;
  std::vector<WhatIfCandidate> rivals;
  for (std::size_t index = 1; index < improvement.steps.size(); ++index) {
    const ImproveStep& step = improvement.steps[index];
    const std::optional<ModelEffect> effect = effect_of(improvement, step);
    if (effect && effect->is_surface()) continue;  // a surface has no single coefficient to move
    const Finding* const finding = finding_of(improvement, index);
    candidates.push_back({step.added, fmt::format("step {}", index), effect,
                          finding != nullptr && finding->is_alike, step.added});
    if (finding == nullptr) continue;
    for (const Alias& alias : finding->aliases)
      rivals.push_back(
          {alias.effect, "instead of " + step.added, alias.correction, alias.is_alike, step.added});
  }
  // Effects that are missing after the last step are not part of it.
  for (WhatIfCandidate& left : what_if_candidates(improvement.steps.back().diagnosis, options.formulas)) {
    left.stands_for.clear();
    rivals.push_back(std::move(left));
  }
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
