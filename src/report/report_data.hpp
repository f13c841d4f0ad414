#pragma once

#include <pcor/report/report.hpp>

#include <cstddef>
#include <string>

namespace pcor::internal::report {

// Input of the browser: samples, intervals and panels, as JSON without the character '<'.
// @throws Error: see report_html
std::string data_json(const Report& report);

std::string base64(const void* bytes, std::size_t count);

// Kind of an item in the browser: "time", "binned", ...
const char* kind_of(const ReportItem& item);

}  // namespace pcor::internal::report
