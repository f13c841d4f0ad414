#include <pcor/compare/comparison_report.hpp>

#include "compare/comparison_panels.hpp"

namespace pcor {

using namespace internal;

Report comparison_report(const Comparison& comparison) {
  ComparisonPanels panels(comparison);
  panels.report().title = "Pressure corrections against " + comparison.reference;
  panels.report().subtitle = "Errors of the model by regime";
  panels.summarise();
  panels.add_panels();
  panels.add_pairs();
  panels.add_tables();
  return std::move(panels.report());
}

}  // namespace pcor
