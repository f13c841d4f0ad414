#pragma once

#include "fit/fit_flights.hpp"

namespace pcor::internal {

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
