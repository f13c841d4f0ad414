#pragma once

#include <string>

namespace pcor {

/// A word of a command line as a POSIX shell takes it: as it is where the shell gives no letter of it a
/// meaning, else in single quotes.
std::string shell_word(const std::string& word);

}  // namespace pcor
