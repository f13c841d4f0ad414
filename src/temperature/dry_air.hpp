#pragma once

#include <string>

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "temperature/height_record.hpp"

namespace pcor::internal {

/// Why the air of a flight must not be taken for dry: it reaches below 5 km, where vapour that is left out
/// looks like a thermometer that reads too low by up to some K. Says which humidity the model could name.
/// Empty where the integral knows the vapour, or the flight stays above.
std::string trouble_with_dry_air(const HeightRecord& record, const ModelDefinition& model,
                                 const Flight& flight);

}  // namespace pcor::internal
