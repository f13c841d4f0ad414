#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <pcor/model_io/model_definition.hpp>
#include <pcor/process/process.hpp>

namespace pcor::internal {

/// Global attributes of an output that hold the SHA-256 of what it was made of.
inline constexpr const char* model_hash_attribute = "pcor_model_sha256";
inline constexpr const char* options_hash_attribute = "pcor_options_sha256";
inline constexpr const char* input_hash_attribute = "pcor_input_sha256";

/// The version of the program and what of the options decides what is in an output, as a text.
std::string options_text(const ProcessOptions& options);

/// The coefficients of a model with their standard errors, where it states them:
/// "static-qp.a2 = 0.0308 +- 0.0012; ...".
std::string coefficients_text(const ModelDefinition& model);

/// Whether a model changes no pressure: all its coefficients are neutral.
bool changes_no_pressure(const ModelDefinition& model, const ProcessOptions& options);

/// What an output says of its origin: names and texts of global attributes. The model is there whole, as the
/// text of its file, so that the result can be found again from the output and the flight alone.
/// @throws Error if the flight cannot be read, or the model cannot be written.
std::vector<std::pair<std::string, std::string>> origin_attributes(const std::filesystem::path& input,
                                                                   const ModelDefinition& model,
                                                                   const ProcessOptions& options);

}  // namespace pcor::internal
