#pragma once

#include <string>
#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include <pcor/report/report.hpp>
#include "base/phrasing.hpp"

namespace pcor::internal::report {

/// Words that reports of a diagnosis share. Numbers that are not known are left out or called unknown.

std::string with_unit(const std::string& number, const std::string& unit);

/// A value with its error, both to two digits of the error.
std::string with_error(double value, double error);

/// Three decimals; "unknown" for what is no number.
std::string hpa(double value);

/// "0.003", or "less than one in a million".
std::string probability(double p);

/// "12 %".
std::string percent(double share);

/// How large the first coefficient with a known usual size is, in units of it; 0 without.
double size_to_usual(const std::vector<Estimate>& estimates);

/// "0.03", "0.71", "2.1", "31": the size of a ratio; empty for what is no number.
std::string ratio_text(double ratio);

/// "pneumatic lag of the static line (static-lag)".
std::string name_with_id(const std::string& title, const std::string& id);

/// "rf01, 2011-11-17 20:10:00 to 20:13:00 UTC (yaw manoeuvre)".
std::string stretch_text(const Evidence& evidence);

/// A finding in one paragraph for the summary of a report.
std::string finding_summary(const Finding& finding);

/// What a diagnosis left without an explanation, in sentences.
std::vector<std::string> unexplained_text(const Unexplained& unexplained);

/// Which variables of the files were not tested, and why; a sentence each.
std::vector<std::string> untested_text(const Unexplained& unexplained);

/// A finding in words that an instrument scientist can put into the report of a project.
/// @param threshold chi2 that an effect had to exceed
ReportText finding_page(const Finding& finding, double threshold, const std::string& heading);

}  // namespace pcor::internal::report
