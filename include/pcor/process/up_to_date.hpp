#pragma once

#include <filesystem>

#include <pcor/process/process.hpp>

namespace pcor {

/// True if `output` is up to date: it holds the SHA-256 of the bytes of the flight `input`, of the model and
/// of the options with this version of the program, and all are equal.
///
/// The flight is read completely, unless the model or the options differ. False if the output does not exist,
/// holds no such digests, or a file cannot be read.
bool is_up_to_date(const std::filesystem::path& output, const std::filesystem::path& input,
                   const ModelDefinition& model, const ProcessOptions& options);

}  // namespace pcor
