#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pcor::internal {

/// Text of a file. @throws Error if it cannot be read, is not a regular file (a device, a pipe) or has more
/// than 16 MB; the message names the expected kind `what`, such as "a model file".
std::string text_of_file(const std::filesystem::path& path, std::string_view what);

}  // namespace pcor::internal
