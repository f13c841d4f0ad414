#include "improve/offered_effect.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "diagnose/findings.hpp"
#include "diagnose/unexplained.hpp"
#include "improve/model_trials.hpp"

namespace pcor::internal {

OfferedEffect offered_effect(const Finding& finding, const Diagnosis& diagnosis) {
  OfferedEffect offered;
  offered.choices.push_back({finding.effect, finding.fixed, finding.is_shared, finding.probability});
  offered.step.title = finding.title;
  offered.is_sure = finding.chi2_reduction > sure_gain * finding.chi2_reduction_error;
  if (is_of_impossible_size(finding)) offered.impossible_size = finding.relative_size;
  std::vector<std::string>& aliases = offered.step.aliases;
  for (const Alias& alias : finding.aliases) {
    aliases.push_back(alias.effect);
    if (alias.probability >= min_probability)
      offered.choices.push_back({alias.correction, alias.fixed, alias.is_shared, alias.probability});
  }
  if (diagnosis.verdict == Verdict::partial) {
    offered.is_named = false;
    offered.caution = "; significant structure remains, so this effect may not be the cause";
  } else if (!aliases.empty()) {
    offered.caution =
        fmt::format("; these flights cannot distinguish the effect from {}{}{}", fmt::join(aliases, ", "),
                    finding.advice.sentence.empty() ? "" : ": ", finding.advice.sentence);
  }
  if (!diagnosis.rival.empty())
    offered.caution += fmt::format("; a straight line in {} may be the cause instead", diagnosis.rival);
  if (!finding.rival.empty()) offered.caution += fmt::format("; {} may be the cause instead", finding.rival);
  return offered;
}

OfferedEffect offered_effect(const EmpiricalPredictor& variable, const std::string& flights) {
  OfferedEffect offered;
  offered.choices.push_back({effect_of(variable, flights)});
  offered.step.title = fmt::format("structure that varies with {}{}", variable.name,
                                   variable.description.empty() ? "" : ", " + variable.description);
  offered.is_named = false;
  offered.is_sure = true;  // only significant predictors are listed
  offered.caution = "; no effect of the catalogue explains this structure: its cause is unknown";
  return offered;
}

}  // namespace pcor::internal
