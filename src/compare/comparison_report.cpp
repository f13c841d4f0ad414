#include <pcor/compare/comparison_report.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "compare/comparison_panels.hpp"

namespace pcor {

using namespace internal;

Report comparison_report(const Comparison& comparison) {
  ComparisonPanels panels(comparison);
  const auto best = std::min_element(
      comparison.models.begin(), comparison.models.end(),
      [](const ModelComparison& a, const ModelComparison& b) { return a.all.rms < b.all.rms; });
  panels.report().title = fmt::format("{}{}: rms residual {:.3f} hPa, {:.1f} times the noise",
                                      comparison.models.size() > 1 ? "Smallest error: " : "", best->name,
                                      best->all.rms, best->all.rms_over_noise());
  panels.report().subtitle = "Comparison with " + comparison.reference;
  panels.summarise();
  // The further references follow the first sentence.
  std::vector<std::string> others;
  for (const Comparison& further : comparison.further) {
    for (const ModelComparison& model : further.models)
      others.push_back(fmt::format("{}{}: bias {:+.3f} hPa, rms {:.3f} hPa.",
                                   comparison.models.size() > 1 ? model.name + ", " : "", further.reference,
                                   model.all.bias, model.all.rms));
  }
  std::vector<std::string>& summary = panels.report().summary;
  summary.insert(summary.begin() + 1, others.begin(), others.end());
  panels.add_panels();
  panels.add_pairs();
  panels.add_tables();
  return std::move(panels.report());
}

}  // namespace pcor
