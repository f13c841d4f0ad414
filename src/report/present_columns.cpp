#include "report/present_columns.hpp"

#include <algorithm>
#include <utility>

#include "numerics/missing.hpp"

namespace pcor::internal {

void add_if_present(Report& report, ReportColumn column) {
  if (has_value(column.values)) report.columns.push_back(std::move(column));
}

bool has_column(const Report& report, std::string_view name) {
  return std::any_of(report.columns.begin(), report.columns.end(),
                     [&](const ReportColumn& column) { return column.name == name; });
}

void add_if_present(Report& report, TimePanel panel) {
  const auto absent = [&report](const std::string& name) { return !has_column(report, name); };
  panel.columns.erase(std::remove_if(panel.columns.begin(), panel.columns.end(), absent),
                      panel.columns.end());
  if (!panel.columns.empty()) report.items.emplace_back(std::move(panel));
}

}  // namespace pcor::internal
