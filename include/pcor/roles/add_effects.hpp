#pragma once

#include <pcor/model_io/model_definition.hpp>

#include <string>
#include <vector>

namespace pcor {

/// The model with `effects` besides, each with its neutral parameters unless it brings its own. Roles that
/// they need and the model does not name get the variable that NCAR's files usually have for them.
/// `variables` are those of a flight, to choose among usual names; empty where no flight is at hand.
/// @throws Error if an effect is in the model already or is not known, or needs a role for which there is no
/// usual variable.
ModelDefinition add_effects(const ModelDefinition& model, const std::vector<ModelEffect>& effects,
                            const std::vector<std::string>& variables = {});

}  // namespace pcor
