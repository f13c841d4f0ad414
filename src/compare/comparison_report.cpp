#include <pcor/compare/comparison_report.hpp>

#include <fmt/format.h>

#include <algorithm>

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
  panels.add_panels();
  panels.add_pairs();
  panels.add_tables();
  return std::move(panels.report());
}

}  // namespace pcor
