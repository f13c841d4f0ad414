#pragma once

#include <string>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// The text of a model file, in a layout that does not depend on how it was read. It may say what the reader
/// refuses.
/// @throws Error for numbers that are not finite and for effects that do not exist.
std::string model_text(const ModelDefinition& file);

}  // namespace pcor::internal
