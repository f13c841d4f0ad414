#pragma once

#include <pcor/improve/improve.hpp>
#include <pcor/report/report.hpp>

namespace pcor {

/// The report of an improvement: the ladder, why it ended, the residual at its foot and at its top, and for
/// each effect that was added the page of its finding.
/// @param start the model at the foot of the ladder
/// @param what_if effects that the reader can add; null for none
Report improvement_report(const Improvement& improvement, const ModelDefinition& start,
                          const WhatIf* what_if = nullptr);

}  // namespace pcor
