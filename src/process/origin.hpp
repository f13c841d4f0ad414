#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <pcor/model_io/model_definition.hpp>
#include <pcor/process/process.hpp>

namespace pcor::internal {

/// Global attributes of an output with the SHA-256 of its inputs.
inline constexpr const char* model_hash_attribute = "pcor_model_sha256";
inline constexpr const char* options_hash_attribute = "pcor_options_sha256";
inline constexpr const char* input_hash_attribute = "pcor_input_sha256";

/// The version of the program and what of the options decides what is in an output, as a text.
std::string options_text(const ProcessOptions& options);

/// Coefficients of a model with stated standard errors: "static-qp.a2 = 0.0308 +- 0.0012; ...".
std::string coefficients_text(const ModelDefinition& model);

/// Whether an effect of the catalogue changes nothing: its coefficients are neutral.
bool is_neutral(const ModelEffect& effect);

/// Whether a model changes no pressure: all its coefficients are neutral.
bool changes_no_pressure(const ModelDefinition& model, const ProcessOptions& options);

/// Provenance of an output: names and texts of global attributes. Contains the complete text of the model
/// file, so that the output and the flight suffice to reproduce the result.
/// @throws Error if the flight cannot be read, or the model cannot be written.
std::vector<std::pair<std::string, std::string>> origin_attributes(const std::filesystem::path& input,
                                                                   const ModelDefinition& model,
                                                                   const ProcessOptions& options);

}  // namespace pcor::internal
