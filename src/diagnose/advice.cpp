#include "diagnose/advice.hpp"

#include <algorithm>

#include "diagnose/separation.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {

void advise(const Analysis& analysis, const std::vector<Candidate>& candidates,
            std::vector<Finding>& findings) {
  if (std::all_of(findings.begin(), findings.end(),
                  [](const Finding& finding) { return finding.aliases.empty(); }))
    return;
  const std::vector<FlownRegime> regimes = flown_regimes(analysis.scores(), [&analysis](std::size_t f) {
    return FlightInBins{analysis.flight(f), analysis.bins(f)};
  });
  const Eigen::Index columns = analysis.scores().columns();
  const Eigen::MatrixXd now = analysis.scores().information.topLeftCorner(columns, columns);
  const double variance = analysis.search().variance(analysis.result().chosen);
  for (std::size_t i = 0; i < findings.size(); ++i) {
    Finding& finding = findings[i];
    if (finding.aliases.empty()) continue;
    const std::size_t winner = analysis.result().chosen[i];
    SeparationProblem rivalry{now, variance, indices_of(analysis.groups()[winner], analysis.base()), {}, {}};
    const Candidate& found = candidates[winner];
    rivalry.size.resize(as_index(found.tested.size()));
    for (std::size_t k = 0; k < found.tested.size(); ++k) {
      const std::size_t position = found.tested[k].index;
      rivalry.size[as_index(k)] = finding.effect.parameters[position] - found.effect.parameters[position];
    }
    std::vector<std::string> rivals;
    for (const Alias& alias : finding.aliases) {
      rivals.push_back(alias.effect);
      std::vector<std::size_t> instead = analysis.result().chosen;
      instead[i] = alias.candidate;
      rivalry.rests.push_back(indices_of(instead, analysis.groups(), analysis.base()));
    }
    const Plan best = best_plan(regimes, rivalry);
    finding.advice.sentence = text_of(best, finding.id(), finding.effect, rivals);
    if (best.regime == nullptr) continue;
    finding.advice.manoeuvre = info_of(best.regime->regime).name;
    finding.advice.duration = best.duration();
    finding.advice.power = best.power;
  }
}

}  // namespace pcor::internal
