#pragma once

#include <pcor/report/report.hpp>

#include <string>
#include <vector>

namespace pcor::internal {

/// The column of that name; null where there is none.
const ReportColumn* column_named(const std::vector<ReportColumn>& columns, const std::string& name);

/// Whether some sample has a value in all of these columns; false where one of them is not there.
bool meet(const std::vector<ReportColumn>& columns, const std::vector<std::string>& names);

}  // namespace pcor::internal
