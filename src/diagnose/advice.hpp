#pragma once

#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include "diagnose/analysis.hpp"
#include "diagnose/candidates.hpp"

namespace pcor::internal {

/// Puts into every finding with aliases which of the regimes that were flown, flown again, would separate it
/// from them, and how surely.
void advise(const Analysis& analysis, const std::vector<Candidate>& candidates,
            std::vector<Finding>& findings);

}  // namespace pcor::internal
