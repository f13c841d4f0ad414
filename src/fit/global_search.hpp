#pragma once

#include <Eigen/Dense>
#include <functional>
#include <string>
#include <vector>

#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// Where a global search may look for a parameter.
struct SearchRange {
  std::string name;
  double lower;
  double upper;
};

/// Looks for starting values without derivatives, between the bounds, over the whole of them (NLopt's
/// controlled random search CRS2, with a fixed seed). Parameters in which the residual is linear are solved
/// for in closed form at every trial, so only the others are searched. It minimises the sum of squares.
///
/// @param parameters all parameters, at their start
/// @param linear for each of them whether the residual is linear in it
/// @param ranges of the wanted ones @return the wanted ones, and zeros for the offsets
/// @throws Error if a parameter to be searched has no bounds, or none is to be searched.
Eigen::VectorXd global_search(FitFlights& flights, const FitSetup& setup, const Eigen::VectorXd& parameters,
                              const std::vector<bool>& linear, const std::vector<SearchRange>& ranges,
                              const std::function<void()>& tell);

}  // namespace pcor::internal
