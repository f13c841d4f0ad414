#pragma once

#include <string>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// The name that a model had before it was fitted.
std::string unfitted_name(const ModelDefinition& model);

/// Gives a derived model a new name, "NAME, fitted to GOTEX rf06 2004-02-18", and the provenance list
/// `before` of its source models, oldest first: name, creation time and source of each, if known. Names do
/// not grow with the number of fits.
/// @param how "fitted to" or "improved on"
void descend(ModelDefinition& made, const ModelDefinition& from, const std::string& how,
             const std::string& flights);

}  // namespace pcor::internal
