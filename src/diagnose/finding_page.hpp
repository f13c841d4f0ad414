#pragma once

#include <string>
#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include <pcor/report/report.hpp>
#include "base/phrasing.hpp"

namespace pcor::internal::report {

/// Text shared by reports of a diagnosis. Unknown numbers are omitted or written as unknown.

std::string with_unit(const std::string& number, const std::string& unit);

/// Number with three decimals; "unknown" for NaN.
std::string hpa(double value);

/// "0.003", or "less than one in a million".
std::string probability(double p);

/// "12 %".
std::string percent(double share);

/// Size of the first coefficient with a known usual size, in units of that size; 0 if there is no such
/// coefficient.
double relative_size_of(const std::vector<CoefficientEstimate>& estimates);

/// Size of a ratio, "0.03", "0.71", "2.1", "31"; empty for NaN.
std::string ratio_text(double ratio);

/// "pneumatic lag of the static line (static-lag)".
std::string name_with_id(const std::string& title, const std::string& id);

/// A finding in one paragraph for the summary of a report: name, size, rivals with their probabilities,
/// advice.
std::string finding_summary(const Finding& finding);

/// Sentences about the unexplained part of a diagnosis.
std::vector<std::string> unexplained_text(const Unexplained& unexplained);

/// Text about a finding, ready for a project report.
/// @param threshold chi2 that an effect had to exceed
ReportText finding_page(const Finding& finding, double threshold, const std::string& heading);

}  // namespace pcor::internal::report
