#pragma once

#include <functional>
#include <nlopt.hpp>
#include <vector>

namespace pcor::internal {

/// Objective that NLopt minimizes.
using Cost = std::function<double(const std::vector<double>&)>;

/// Runs a search from `x` and stores its end point there, also if rounding errors stop it. An exception of
/// the cost ends the search and is rethrown unchanged.
void minimize_objective(nlopt::opt& search, const Cost& cost, std::vector<double>& x);

}  // namespace pcor::internal
