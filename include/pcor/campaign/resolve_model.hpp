#pragma once

#include <pcor/campaign/flight_set.hpp>
#include <pcor/model_io/model_definition.hpp>

#include <string>
#include <vector>

namespace pcor {

/// A model that leaves variables open, completed (`resolve_variables`) by the first flight that can be read
/// and completes it. All others have to choose the same variables: a result must not depend on which flights
/// stand beside.
/// @param flights at least one
/// @param notes get what was chosen, a sentence each
/// @throws Error that of the first flight where none completes the model, or Error if two choose differently
ModelDefinition resolve_model(const ModelDefinition& open, const FlightSet& flights,
                              std::vector<std::string>& notes);

}  // namespace pcor
