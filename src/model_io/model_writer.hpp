#pragma once

#include <string>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// Text of a model file, in a layout that is independent of the layout of the file it was read from. The
/// reader may refuse the text of an invalid model.
/// @throws Error for numbers that are not finite and for effects that do not exist.
std::string model_text(const ModelDefinition& file);

}  // namespace pcor::internal
