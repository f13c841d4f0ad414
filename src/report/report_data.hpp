#pragma once

#include <pcor/report/report.hpp>

#include <string>

namespace pcor::internal::report {

// Throws Error if the report cannot be drawn: see report_html.
void check(const Report& report);

// What the browser draws from: the samples, the intervals and the panels, as JSON in which no '<' occurs.
std::string data_json(const Report& report);

// "time", "binned", ...: what the browser calls the kind of an item.
const char* kind_of(const ReportItem& item);

}  // namespace pcor::internal::report
