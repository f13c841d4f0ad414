#pragma once

#include <functional>
#include <nlopt.hpp>
#include <vector>

namespace pcor::internal {

/// What NLopt makes as small as it can.
using Cost = std::function<double(const std::vector<double>&)>;

/// Runs a search from `x` on, and leaves there where it ends: where it cannot go on for rounding too. What
/// the cost throws ends the search and comes out as it is.
void minimize_objective(nlopt::opt& search, const Cost& cost, std::vector<double>& x);

}  // namespace pcor::internal
