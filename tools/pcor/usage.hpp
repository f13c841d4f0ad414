#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace pcor::tool {

/// One line about a usage error: what was wrong, what may have been meant, and where all is listed.
/// @param words the command line, without the program
std::string usage_message(const CLI::App& program, const std::string& message,
                          const std::vector<std::string>& words);

/// What is wrong with a list of flights behind `--holdout`, which takes one flight each time, as in
/// `pcor refit first.nc --holdout *.nc`: the others would be fitted without a word. Empty where nothing is.
/// @param words the command line, without the program
std::string flights_behind_holdout(const CLI::App& program, const std::vector<std::string>& words);

}  // namespace pcor::tool
