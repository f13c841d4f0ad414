#pragma once

#include <pcor/report/report.hpp>

#include <string>
#include <vector>

namespace pcor::internal {

/// Column with a name; null if absent.
const ReportColumn* column_named(const std::vector<ReportColumn>& columns, const std::string& name);

/// Whether some sample has a value in all of these columns; false if one of them is absent.
bool meet(const std::vector<ReportColumn>& columns, const std::vector<std::string>& names);

}  // namespace pcor::internal
