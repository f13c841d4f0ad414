#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::tool {

/// Adds `--force` to a sub-command that writes a model.
void add_force_option(CLI::App& command, bool& force);

/// Refuses a model that is worse than its input by its statistics. With `force` it is accepted, and its
/// provenance states the reason in `forced`.
///
/// @param worse reason, a sentence without its full stop; empty if the model is not worse
/// @throws Error with the reason, if `worse` is not empty and `force` is false
void refuse_worse(const std::string& worse, bool force, ModelDefinition& model);

}  // namespace pcor::tool
