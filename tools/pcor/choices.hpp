#pragma once

#include <string>
#include <vector>

namespace pcor::tool {

/// Says on standard error, unless `quiet`, what was chosen for the user, a sentence each, and keeps it for
/// `choices_of_this_run`.
void tell_choices(const std::vector<std::string>& choices, bool quiet);

/// What was chosen in this run: variables and models that were left open, flights that were left out. JSON
/// results and reports say it too.
const std::vector<std::string>& choices_of_this_run();

}  // namespace pcor::tool
