#pragma once

#include <pcor/diagnose/diagnose.hpp>
#include <pcor/diagnose/what_if.hpp>
#include <pcor/report/report.hpp>

#include <string>
#include <utility>
#include <vector>

namespace pcor {

/// Verdict in one line, with the names of the missing effects; no full stop.
std::string verdict_text(const Diagnosis& diagnosis);

/// Among the effects that were tested and not found: how many would be detected at their usual size, and how
/// many have a known usual size. If the first number is 0, the flights cannot test the model.
std::pair<std::size_t, std::size_t> detectable_at_usual_size(const Diagnosis& diagnosis);

/// Estimates with standard errors, both to two digits of the error: "tau = 0.151 +- 0.006 s".
std::string estimates_text(const std::vector<CoefficientEstimate>& estimates);

/// Upper limits of the coefficients of an undetected effect: "|tau| < 0.12 s".
std::string limits_text(const UpperLimit& limit);

/// Report of a diagnosis: missing effects with significance, size and alternatives; the residual before and
/// after in time and against the inputs of each effect; the evidence in time and over Mach number and
/// pressure; the ranking with alternatives; and a page of text for each finding.
/// @param model the diagnosed model
/// @param what_if effects that the reader can add; nullptr: no such panel
Report diagnosis_report(const Diagnosis& diagnosis, const ModelDefinition& model,
                        const WhatIf* what_if = nullptr);

/// Whether an effect is more than five times its usual size: another cause is likely.
inline bool is_unusually_large(const Finding& finding) { return finding.relative_size > 5.0; }

/// Family, possible components and relative size of an effect: "family: zero; place: p-transducer or
/// other-system; 15 times its usual size: ...".
std::string kind_text(const Finding& finding);

}  // namespace pcor
