#pragma once

#include <string_view>

#include <pcor/model_io/model_definition.hpp>

#include "base/toml_reader.hpp"

namespace pcor::internal {

/// Adds the list [[effect]] of the model file `name` to `file`: the effects and the fit settings of their
/// parameters. @throws Error
void read_effects(const Entry& effects, std::string_view name, ModelDefinition& file);

}  // namespace pcor::internal
