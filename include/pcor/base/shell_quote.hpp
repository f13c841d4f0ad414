#pragma once

#include <string>

namespace pcor {

/// Argument quoted for a POSIX shell: unchanged if it has no special characters, otherwise in single quotes.
std::string shell_quote(const std::string& word);

/// File name quoted for a POSIX shell; a leading dash, which would start an option, becomes ./-name.
std::string shell_path(const std::string& path);

/// Option and value, joined by = if the value could be parsed as an option.
std::string shell_option(const std::string& name, const std::string& value);

}  // namespace pcor
