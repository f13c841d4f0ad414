#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace pcor::tool {

/// Usage error in one line: what is wrong, suggestions, and where to find the list.
/// @param words the command line, without the program
std::string usage_message(const CLI::App& program, const std::string& message,
                          const std::vector<std::string>& words);

/// Error of a list of flights after `--holdout`, which takes one flight each time, as in `pcor refit first.nc
/// --holdout *.nc`: the others would be fitted silently. Empty if the list is valid.
/// @param words the command line, without the program
std::string flights_behind_holdout(const CLI::App& program, const std::vector<std::string>& words);

}  // namespace pcor::tool
