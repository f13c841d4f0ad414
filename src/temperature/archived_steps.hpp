#pragma once

#include <vector>

#include "campaign/flight_air.hpp"

namespace pcor::internal {

/// -(R_a/g0) ln(p_i/p_(i-1)) from the mean of the record before to that of every record, as `pcor process
/// --hydrostatic` wrote it, m/K; NaN if missing. Takes the correction of the temperature that the file's
/// ATX has already off the temperature of `air`.
/// @throws Error if the file was not written so, or with a model whose pressures are others than those of
/// `model`; the correction of the temperature may be another.
std::vector<double> archived_steps(const Flight& flight, const ModelDefinition& model, FlightAir& air);

}  // namespace pcor::internal
