#pragma once

#include <pcor/report/report.hpp>

#include <string>
#include <vector>

namespace pcor::internal {

/// Column with a name; null if absent.
const ReportColumn* column_named(const std::vector<ReportColumn>& columns, const std::string& name);

/// Whether some sample has a value in all of these columns; false if one of them is absent.
bool meet(const std::vector<ReportColumn>& columns, const std::vector<std::string>& names);

/// First sample of each flight, and the number of samples.
std::vector<std::size_t> flight_bounds(const Report& report);

/// Names of the columns that a report has.
std::vector<std::string> present(const Report& report, std::vector<std::string> names);

/// Adds a column, unless it has no value.
void add_if_present(Report& report, ReportColumn column);

/// Adds a panel of its available columns; adds no panel if all are missing.
void add_if_present(Report& report, TimePanel panel);

}  // namespace pcor::internal
