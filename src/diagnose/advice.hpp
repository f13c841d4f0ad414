#pragma once

#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include "diagnose/analysis.hpp"
#include "diagnose/candidates.hpp"

namespace pcor::internal {

/// Adds to every finding with aliases the repeated regime that would separate it from them, and the
/// probability of success.
void advise(const Analysis& analysis, const std::vector<Candidate>& candidates,
            std::vector<Finding>& findings);

}  // namespace pcor::internal
