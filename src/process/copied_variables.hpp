#pragma once

#include <string>
#include <vector>

#include <pcor/flight/flight_writer.hpp>
#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// Names the variables of the flight that say where the aircraft was: those that the flight or the model
/// name, else the usual ones. Empty where there is none.
void name_coordinates(const Flight& flight, const ModelDefinition& model, FileDescription& description);

/// The variables that a fit of temperature needs besides those of the model, as far as the flight has them:
/// the height, the way, and how it was flown.
std::vector<std::string> flown_variables(const Flight& flight, const ModelDefinition& model);

}  // namespace pcor::internal
