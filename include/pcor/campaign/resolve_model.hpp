#pragma once

#include <pcor/base/note.hpp>
#include <pcor/campaign/flight_set.hpp>
#include <pcor/model_io/model_definition.hpp>

namespace pcor {

/// Model with its undefined variables resolved (`resolve_variables`) from the first readable flight that
/// resolves it. All other flights must resolve to the same variables: the result must not depend on the
/// combination of flights.
/// @param flights at least one
/// @param notes receives the choices, one sentence each
/// @throws Error of the first flight if no flight resolves the model, or if two flights resolve it
/// differently
ModelDefinition resolve_model(const ModelDefinition& open, const FlightSet& flights, Notes& notes);

}  // namespace pcor
