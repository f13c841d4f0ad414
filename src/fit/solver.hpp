#pragma once

#include "fit/fit_flights.hpp"

namespace pcor::internal {

/// Fits the parameters that the flights' setup wants; the others stay as they are in `from`.
///
/// The linear problem is solved in closed form, within the bounds; its residuals tell the noise, by which the
/// samples count from then on, and the deviation, which scales the loss; then Ceres minimises the loss, from
/// Huber's solution where the loss asks for it, until the deviation stays.
/// @throws Error if samples are too few, or residuals are not numbers.
Solution solve(FitFlights& flights, Solution from);

}  // namespace pcor::internal
