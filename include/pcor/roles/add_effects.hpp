#pragma once

#include <pcor/model_io/model_definition.hpp>

#include <string>
#include <vector>

namespace pcor {

/// Model with additional `effects`, with neutral parameters unless given. Roles that they need and the model
/// does not name get the usual variable of NCAR's files. `variables` are those of a flight, to choose among
/// usual names; empty if no flight is available.
/// @throws Error if an effect is already in the model or unknown, or needs a role without a usual variable.
ModelDefinition add_effects(const ModelDefinition& model, const std::vector<ModelEffect>& effects,
                            const std::vector<std::string>& variables = {});

}  // namespace pcor
