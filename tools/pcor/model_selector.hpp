#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <pcor/campaign/flight_set.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "command.hpp"

namespace pcor::tool {

/// Reads a model that is to run on flights. What it leaves open, the first flight's aircraft names
/// (`resolve_variables`); what was chosen goes to standard error where text is wanted, and is kept for
/// `choices_of_this_run`.
/// @throws Error as `read_model` and `resolve_variables`
ModelDefinition read_model_for(const std::filesystem::path& model, const FlightSet& flights,
                               const CommonOptions& options);

/// The model of a folder that a flight is to be corrected by (`model_candidate`), with what it leaves to the
/// flight's aircraft. Which it is, is among the choices of this run.
/// @throws Error as these
ModelDefinition model_for_flight(const std::vector<std::filesystem::path>& models,
                                 const std::filesystem::path& flight, const CommonOptions& options);

}  // namespace pcor::tool
