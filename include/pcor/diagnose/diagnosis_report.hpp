#pragma once

#include <pcor/diagnose/diagnose.hpp>
#include <pcor/diagnose/what_if.hpp>
#include <pcor/report/report.hpp>

#include <string>
#include <vector>

namespace pcor {

/// The verdict in one line, with the names of what is missing; no full stop.
std::string verdict_text(const Diagnosis& diagnosis);

/// "tau = 0.151 ± 0.006 s": values with their errors, both to two digits of the error.
std::string estimates_text(const std::vector<Estimate>& estimates);

/// "|tau| < 0.12 s": how large the coefficients of an effect that was not found may be.
std::string limits_text(const UpperLimit& limit);

/// The report of a diagnosis: what is missing, how sure that is, how large, and what cannot be told apart;
/// the residual before and after in time and against the inputs of each effect, the evidence in time and over
/// Mach number and pressure, the ranking with its rivals, and a page in words for each finding.
/// @param model the one that was diagnosed
/// @param what_if effects that the reader can add; null for none
Report diagnosis_report(const Diagnosis& diagnosis, const ModelDefinition& model,
                        const WhatIf* what_if = nullptr);

/// What kind of effect it is, where it may act, and how large it is beside the usual: "family: zero; place:
/// p-transducer or other-system; 15 times its usual size: ...".
std::string kind_text(const Finding& finding);

}  // namespace pcor
