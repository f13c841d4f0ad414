#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>
#include <vector>

#include <pcor/flight/readable_flights.hpp>

namespace pcor::tool {

/// Adds `--processes` to a command whose flights several processes share.
void add_processes_option(CLI::App& command);

/// Where flights are opened that may be damaged: pcor may make a copy of itself, pcor_mpi may not.
OpenedIn place_to_open();

/// How many processes `--processes` asks for, to be begun before the command line is read. 1 where it does
/// not ask, or not as it should, which is said when it is read.
std::size_t processes_to_begin(const std::vector<std::string>& words);

/// The words of a command line without `--processes`, which changes nothing of what comes of it.
std::vector<std::string> without_processes(const std::vector<std::string>& words);

}  // namespace pcor::tool
