#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::tool {

/// Adds `--force` to a sub-command that writes a model.
void add_force_option(CLI::App& command, bool& force);

/// Stops a model that its own numbers call worse than what it started from. Where the user insists
/// it goes on, and the model says why it would have been refused: `forced` of its provenance.
///
/// @param worse why it is worse, a sentence without its full stop; empty where it is not
/// @throws Error with the reason, if `worse` is not empty and `force` is false
void refuse_worse(const std::string& worse, bool force, ModelDefinition& model);

}  // namespace pcor::tool
