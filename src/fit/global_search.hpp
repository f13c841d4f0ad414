#pragma once

#include <Eigen/Dense>

#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// Searches starting values between the bounds without derivatives (NLopt's controlled random search CRS2,
/// with a fixed seed). Parameters in which the residual is linear are solved for in closed form at every
/// trial, so only the others are searched. It minimises the sum of squares.
///
/// @param values of all parameters @return those of the free ones
/// @throws Error if a searched parameter has no bounds, or no parameter is searched.
Eigen::VectorXd global_search(FitFlights& flights, Eigen::VectorXd values,
                              const std::vector<std::size_t>& free);

}  // namespace pcor::internal
