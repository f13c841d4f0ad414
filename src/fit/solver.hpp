#pragma once

#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// Fits the parameters wanted by the flights' setup; others keep their values in `from`.
///
/// The linear problem is solved in closed form within the bounds; its residuals give the noise that weights
/// the bins. Ceres then minimises the loss of the innovations, from Huber's solution if the loss requires it,
/// until their deviation is stable. Derivatives that do not follow the coefficients are renewed until the
/// solution converges.
/// @throws Error if samples are too few, or residuals are not numbers.
Solution solve(FitFlights& flights, Solution from);

}  // namespace pcor::internal
