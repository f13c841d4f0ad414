#pragma once

#include <string>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// The name that a model had before it was fitted.
std::string unfitted_name(const ModelDefinition& model);

/// Gives a model that was made from another a name of its own, "NAME, fitted to GOTEX rf06 2004-02-18", and
/// has its provenance list, as `before`, the models that it came from, the oldest first: the name of each,
/// when it was made and its source, as far as it says. Names do not grow with the number of fits.
/// @param how "fitted to" or "improved on"
void descend(ModelDefinition& made, const ModelDefinition& from, const std::string& how,
             const std::string& flights);

}  // namespace pcor::internal
