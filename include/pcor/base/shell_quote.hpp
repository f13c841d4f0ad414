#pragma once

#include <string>

namespace pcor {

/// A word of a command line as a POSIX shell takes it: as it is where the shell gives no letter of it a
/// meaning, else in single quotes.
std::string shell_quote(const std::string& word);

/// The same for the name of a file: one that begins with a dash, which would be taken for an option, becomes
/// ./-name.
std::string shell_path(const std::string& path);

/// An option and its value, joined by = where the value would be taken for an option.
std::string shell_option(const std::string& name, const std::string& value);

}  // namespace pcor
