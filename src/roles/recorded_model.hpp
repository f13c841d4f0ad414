#pragma once

#include <optional>
#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "roles/usual_variables.hpp"

namespace pcor::internal {

/// The measured pairs of pressures in the flight, sorted by decreasing likelihood.
std::vector<PressurePair> measured_pairs(const Flight& flight);

/// Default model without corrections if no model is given. Pressures: the first available of the pair
/// corrected by the flight's own processing (PSXC, QCXC), its reference pair (PSX, QCX) and the measured
/// pairs. Temperature: the ambient temperature (ATX), otherwise a recovery temperature with the recovery
/// factor of its thermometer (see `VariableNaming::thermometers`). Empty if the flight has no pair with
/// values.
std::optional<ModelDefinition> recorded_model(const Flight& flight);

/// A model of a measured pair without corrections.
ModelDefinition model_of(const PressurePair& pair);

}  // namespace pcor::internal
