#pragma once

#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include "diagnose/analysis.hpp"
#include "diagnose/candidates.hpp"

namespace pcor::internal {

/// Puts into every finding with aliases which manoeuvre would tell it from them, and how surely.
///
/// Standard manoeuvres are made from what a few of the flights teach of the aircraft, and their columns join
/// those of the flights at the noise of the flights. A rival is told apart where chi2 falls by more than 9
/// with it; the difference is normal with mean D and variance 4 D, where D is what of the effect, at its
/// estimated size, the rival cannot imitate.
void advise(const Analysis& analysis, const CandidateSet& set, const ModelFile& model,
            const MaskOptions& mask, std::vector<Finding>& findings);

}  // namespace pcor::internal
