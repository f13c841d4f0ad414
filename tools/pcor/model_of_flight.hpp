#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <pcor/laws/model_file.hpp>
#include "command.hpp"

namespace pcor::tool {

/// Reads a model that is to run on flights. What it leaves open, the first flight's aircraft names
/// (`with_roles`); what was chosen goes to standard error where text is wanted.
/// @throws Error as `read_model` and `with_roles`
ModelFile read_model_for(const std::filesystem::path& model,
                         const std::vector<std::filesystem::path>& flights, const CommonOptions& options);

}  // namespace pcor::tool
