#pragma once

#include <string_view>

#include <pcor/laws/model_file.hpp>

namespace pcor::internal {

/// Reads the text of a model file, which messages call `name`, and refuses what has no meaning with the place
/// where it stands. @throws Error
ModelFile read_model_text(std::string_view text, std::string_view name);

}  // namespace pcor::internal
