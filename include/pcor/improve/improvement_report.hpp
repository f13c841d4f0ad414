#pragma once

#include <pcor/improve/improve.hpp>
#include <pcor/report/report.hpp>

namespace pcor {

/// Report of an improvement: the selection path, the reason for its end, the residual before and after, and
/// the page of the finding for each added effect.
/// @param start the initial model
/// @param what_if effects that the reader can add; nullptr: no such panel
Report improvement_report(const Improvement& improvement, const ModelDefinition& start,
                          const WhatIf* what_if = nullptr);

}  // namespace pcor
