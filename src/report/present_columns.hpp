#pragma once

#include <string_view>

#include <pcor/report/report.hpp>

namespace pcor::internal {

/// Optional columns of a flight, and panels of the available ones.

/// Adds a column, unless it has no value.
void add_if_present(Report& report, ReportColumn column);

bool has_column(const Report& report, std::string_view name);

/// Adds a panel of its available columns; adds no panel if all are missing.
void add_if_present(Report& report, TimePanel panel);

}  // namespace pcor::internal
