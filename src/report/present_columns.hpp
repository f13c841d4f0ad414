#pragma once

#include <string_view>

#include <pcor/report/report.hpp>

namespace pcor::internal {

/// Columns that a flight may have or not, and the panels of those that are there.

/// Adds a column, unless it has no value.
void add_if_present(Report& report, ReportColumn column);

bool has_column(const Report& report, std::string_view name);

/// Adds a panel of those of its columns that are there; nothing where none is.
void add_if_present(Report& report, TimePanel panel);

}  // namespace pcor::internal
