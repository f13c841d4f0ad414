#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

namespace pcor::tool {

/// The file of a model that a user names: what is given, if it is a file or looks like one (with a '/' or
/// ".toml"); else the model of that name in the folders of the environment variable PCOR_MODELS, or among
/// those that come with the program. Nothing is made of no name.
/// @throws Error with what may have been meant, if there is no such model.
std::string model_file(const std::string& given);

/// The files of all models that have a name, those of the user first, each name once.
std::vector<std::filesystem::path> named_models();

/// The files of all models in a folder, by name. @throws Error if there is none.
std::vector<std::filesystem::path> models_in(const std::filesystem::path& folder);

/// A reference as --reference takes it, in which a model may be named: "static:c130-psfrd-eq18".
/// @throws Error as `model_file`.
std::string reference_with_model_file(const std::string& given);

/// Has the options --model, --second and --reference of all sub-commands take models by name.
void take_models_by_name(CLI::App& program);

}  // namespace pcor::tool
