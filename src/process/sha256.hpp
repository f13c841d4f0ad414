#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pcor::internal {

/// The SHA-256 of a text, 64 hexadecimal digits.
std::string sha256_of_text(std::string_view text);

/// The SHA-256 of a file's bytes, as `sha256sum` prints it. Memory does not depend on its length.
/// @throws Error if the file cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace pcor::internal
