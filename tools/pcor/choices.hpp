#pragma once

#include <string>
#include <vector>

#include <pcor/base/note.hpp>

namespace pcor::tool {

/// Prints automatic choices on standard error, unless `quiet`, a sentence each, and stores them for
/// `choices_of_this_run`.
void tell_choices(const Notes& choices, bool quiet);

/// Automatic choices of this run: variables and models that were not specified, skipped flights. JSON results
/// and reports include them.
const std::vector<std::string>& choices_of_this_run();

}  // namespace pcor::tool
