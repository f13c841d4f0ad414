#pragma once

#include <filesystem>

#include <pcor/process/process.hpp>

namespace pcor {

/// Whether processing the flight `input` would make `output` once more: the output holds the SHA-256 of the
/// flight's bytes, of the model and of the options with this version of the program, and all are the same.
///
/// The flight is read whole, unless the model or the options differ. False where there is no output, or one
/// that does not say, or where something cannot be read.
bool is_up_to_date(const std::filesystem::path& output, const std::filesystem::path& input,
                   const ModelDefinition& model, const ProcessOptions& options);

}  // namespace pcor
