#pragma once

#include <pcor/offline/diagnose.hpp>
#include <pcor/offline/improve.hpp>
#include <pcor/offline/report.hpp>

namespace pcor {

/// The report of a diagnosis: what is missing, how sure that is, how large, and what cannot be told apart;
/// the residual before and after in time and against the inputs of each effect, the evidence in time and over
/// Mach number and pressure, the ranking with its rivals, and a page in words for each finding.
/// @param model the one that was diagnosed
Report diagnosis_report(const Diagnosis& diagnosis, const ModelFile& model);

/// The report of an improvement: the ladder, why it ended, the residual at its foot and at its top, and for
/// each effect that was added the page of its finding.
/// @param start the model at the foot of the ladder
Report improvement_report(const Improvement& improvement, const ModelFile& start);

}  // namespace pcor
