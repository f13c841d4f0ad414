#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

namespace pcor::tool {

/// File of a model that a user names: the given path, if it is a file or looks like one (with a '/' or
/// ".toml"); otherwise the model with this name in the folders of the environment variable PCOR_MODELS, or
/// among the models of the program. An empty name stays empty.
/// @throws Error with suggestions, if there is no such model.
std::string model_file(const std::string& given);

/// File of a scenario that a user names, in the same way, in the folder "scenarios" beside one of models.
std::string scenario_file(const std::string& given);

/// Files of all named models, models of the user first, each name once.
std::vector<std::filesystem::path> named_models();

/// Files of all models in a folder, by name. @throws Error if the folder has no models.
std::vector<std::filesystem::path> models_in(const std::filesystem::path& folder);

/// Value of --reference, in which a model may be named: "static:c130-psfrd-eq18".
/// @throws Error as does `model_file`.
std::string reference_with_model_file(const std::string& given);

/// Model file, and value of --reference, for a command to copy, quoted for a shell: a model that the user
/// named has this name.
std::string model_argument(const std::string& file);
std::string reference_argument(const std::string& reference);

/// Enables names of models in the options --model, --second, --candidates and --reference of all
/// sub-commands, and names of scenarios.
void take_models_by_name(CLI::App& program);

}  // namespace pcor::tool
