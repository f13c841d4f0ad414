#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <pcor/campaign/flight_set.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "command.hpp"

namespace pcor::tool {

/// Reads a model for flights. Unspecified variables follow from the aircraft of the first flight
/// (`resolve_variables`); the choices are printed on standard error if text is requested, and kept for
/// `choices_of_this_run`.
/// @throws Error as do `read_model` and `resolve_variables`
ModelDefinition read_model_for(const std::filesystem::path& model, const FlightSet& flights,
                               const CommonOptions& options);

/// Model of a folder that applies to a flight (`model_candidate`), with open variables from the flight's
/// aircraft. The choice is recorded in the choices of this run.
/// @throws Error as do these
ModelDefinition model_for_flight(const std::vector<std::filesystem::path>& models,
                                 const std::filesystem::path& flight, const CommonOptions& options);

}  // namespace pcor::tool
