#pragma once

#include <string>

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "temperature/height_record.hpp"

namespace pcor::internal {

/// Reason against assuming dry air for a flight: it reaches below 5 km, where neglected vapour resembles a
/// thermometer that reads too low by up to a few K. Names a humidity variable for the model, if there is one.
/// Empty if the integral includes the vapour, or the flight stays above.
std::string trouble_with_dry_air(const HeightRecord& record, const ModelDefinition& model,
                                 const Flight& flight);

}  // namespace pcor::internal
