#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <pcor/model_io/model_definition.hpp>
#include <pcor/process/process.hpp>

namespace pcor::internal {

/// Whether a model changes no pressure: all its coefficients are neutral.
bool changes_no_pressure(const ModelDefinition& model, const ProcessOptions& options);

/// The SHA-256 of a file's bytes, as `sha256sum` prints it. Memory does not depend on its length.
/// @throws Error if the file cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

/// Provenance of an output: names and texts of global attributes. Contains the complete text of the model
/// file, so that the output and the flight suffice to reproduce the result.
/// @throws Error if the model cannot be written.
std::vector<std::pair<std::string, std::string>> origin_attributes(const std::filesystem::path& input,
                                                                   const std::string& input_sha256,
                                                                   const ModelDefinition& model,
                                                                   const ProcessOptions& options);

/// Whether `output` has the SHA-256 of the bytes of the flight `input`, of the model and of the options with
/// this version of the program. False if a file cannot be read. The flight is read only if the others are
/// equal.
bool is_up_to_date(const std::filesystem::path& output, const std::filesystem::path& input,
                   const ModelDefinition& model, const ProcessOptions& options);

}  // namespace pcor::internal
