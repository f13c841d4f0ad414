#pragma once

#include <string>

#include <pcor/campaign/flight_set.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/residuals/reference.hpp>

namespace pcor::internal {

/// The static pressure of a reference, if it is that of the model or is computed from it in the first flight:
/// its noise and its errors cancel. Empty for other references.
std::string circular_pressure(const FlightSet& flights, const ModelDefinition& model,
                              const Reference& reference);

}  // namespace pcor::internal
