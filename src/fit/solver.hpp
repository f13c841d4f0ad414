#pragma once

#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// Fits the parameters that the flights' setup wants; the others stay as they are in `from`.
///
/// The linear problem is solved in closed form, within the bounds; its residuals tell the noise, by which the
/// bins count from then on; then Ceres minimises the loss of the innovations, from Huber's solution where the
/// loss asks for it, until their deviation stays. Derivatives that do not follow the coefficients are renewed
/// until the solution stands still.
/// @throws Error if samples are too few, or residuals are not numbers.
Solution solve(FitFlights& flights, Solution from);

}  // namespace pcor::internal
