#pragma once

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

/// Fits the free parameters; others keep their values in `from`.
///
/// The linear problem is solved in closed form within the bounds; its residuals give the weight of each
/// reference. Weighted least squares then minimise the loss of the innovations, from Huber's solution if the
/// loss requires it, until their deviation is stable. Derivatives that do not follow the coefficients are
/// renewed until the solution converges.
/// @param free some of the requested parameters
/// @param is_stage keeps the weights and the deviation of the whole fit
/// @throws Error if samples are too few, or residuals are not numbers.
Solution solve(FitFlights& flights, Solution from, const std::vector<std::size_t>& free,
               bool is_stage = false);

}  // namespace pcor::internal
