#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <pcor/campaign/flight_set.hpp>
#include <pcor/laws/model_file.hpp>
#include "command.hpp"

namespace pcor::tool {

/// Reads a model that is to run on flights. What it leaves open, the first flight's aircraft names
/// (`with_roles`); what was chosen goes to standard error where text is wanted, and is kept for
/// `choices_of_this_run`.
/// @throws Error as `read_model` and `with_roles`
ModelFile read_model_for(const std::filesystem::path& model, const FlightSet& flights,
                         const CommonOptions& options);

/// The model of a folder that a flight is to be corrected by (`law_of_flight`), with what it leaves to the
/// flight's aircraft. Which it is, is among the choices of this run.
/// @throws Error as these
ModelFile model_for_flight(const std::vector<std::filesystem::path>& models,
                           const std::filesystem::path& flight, const CommonOptions& options);

}  // namespace pcor::tool
