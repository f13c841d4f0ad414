#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pcor::internal {

/// The text of a file. @throws Error if it cannot be read, is no regular file (a device, a pipe) or has more
/// than 16 MB, which says that it should be `what`, such as "a model file".
std::string text_of_file(const std::filesystem::path& path, std::string_view what);

}  // namespace pcor::internal
