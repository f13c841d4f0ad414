#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>
#include <vector>

namespace pcor::tool {

/// Adds `--processes` to a command whose flights several processes share.
void add_processes_option(CLI::App& command);

/// Number of processes requested by `--processes`, read before the command line is parsed. 1 if the option is
/// absent or invalid, which the parser reports.
std::size_t processes_to_begin(const std::vector<std::string>& words);

/// Words of a command line without `--processes`, which does not change the results.
std::vector<std::string> without_processes(const std::vector<std::string>& words);

}  // namespace pcor::tool
