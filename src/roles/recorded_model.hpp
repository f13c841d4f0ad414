#pragma once

#include <optional>
#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "roles/usual_variables.hpp"

namespace pcor::internal {

/// The pairs of pressures as measured that the flight has, the likeliest first.
std::vector<PressurePair> measured_pairs(const Flight& flight);

/// The model that stands in where none is given: the pressures that the flight's own processing corrected
/// (PSXC, QCXC), else its reference (PSX, QCX), else the first of the pairs as measured, with its ambient
/// temperature (ATX), else a recovery temperature with the recovery factor of its thermometer (see
/// `VariableNaming::thermometers`). Nothing is added to them. Absent where the flight has no pair with
/// values.
std::optional<ModelDefinition> recorded_model(const Flight& flight);

/// A model of a pair as it is measured: nothing is added.
ModelDefinition model_of(const PressurePair& pair);

}  // namespace pcor::internal
