#pragma once

#include <pcor/diagnose/diagnose.hpp>
#include <pcor/report/report.hpp>

namespace pcor {

/// The report of a diagnosis: what is missing, how sure that is, how large, and what cannot be told apart;
/// the residual before and after in time and against the inputs of each effect, the evidence in time and over
/// Mach number and pressure, the ranking with its rivals, and a page in words for each finding.
/// @param model the one that was diagnosed
Report diagnosis_report(const Diagnosis& diagnosis, const ModelFile& model);

}  // namespace pcor
