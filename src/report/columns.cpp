#include "report/columns.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace pcor::internal
