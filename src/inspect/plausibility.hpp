#pragma once

#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/inspect/inspect.hpp>
#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// Implausible series of a model on a flight: pressures against height, airspeed and each other, the
/// temperature against height, angles in other units, ground speeds against positions, jumps, and values in
/// coarse steps.
std::vector<Problem> find_problems(const Flight& flight, const ModelDefinition& model);

}  // namespace pcor::internal
