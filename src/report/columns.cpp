#include "report/columns.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "numerics/missing.hpp"

namespace pcor::internal {

const ReportColumn* column_named(const std::vector<ReportColumn>& columns, const std::string& name) {
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [&name](const ReportColumn& column) { return column.name == name; });
  return found == columns.end() ? nullptr : &*found;
}

bool meet(const std::vector<ReportColumn>& columns, const std::vector<std::string>& names) {
  std::vector<const std::vector<double>*> all;
  for (const std::string& name : names) {
    const ReportColumn* const column = column_named(columns, name);
    if (column == nullptr) return false;
    all.push_back(&column->values);
  }
  for (std::size_t i = 0; !all.empty() && i < all.front()->size(); ++i) {
    if (std::all_of(all.begin(), all.end(), [i](const auto* values) { return std::isfinite((*values)[i]); }))
      return true;
  }
  return false;
}

std::vector<std::size_t> flight_bounds(const Report& report) {
  std::vector<std::size_t> bounds = report.flight_starts;
  if (bounds.empty() && !report.time.empty()) bounds.push_back(0);
  bounds.push_back(report.time.size());
  return bounds;
}

void add_if_present(Report& report, ReportColumn column) {
  if (has_value(column.values)) report.columns.push_back(std::move(column));
}

std::vector<std::string> present(const Report& report, std::vector<std::string> names) {
  names.erase(
      std::remove_if(names.begin(), names.end(),
                     [&](const std::string& name) { return column_named(report.columns, name) == nullptr; }),
      names.end());
  return names;
}

void add_if_present(Report& report, TimePanel panel) {
  panel.columns = present(report, std::move(panel.columns));
  if (!panel.columns.empty()) report.items.emplace_back(std::move(panel));
}

}  // namespace pcor::internal
