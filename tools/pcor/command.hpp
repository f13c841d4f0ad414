#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

namespace pcor::tool {

/// The options that every sub-command has.
struct CommonOptions {
  std::string json;    ///< where the machine-readable result goes, `-` for standard output; empty for nowhere
  bool quiet = false;  ///< no text for people
};

/// Adds the common options to a sub-command.
void add_common_options(CLI::App& command, CommonOptions& options);

/// Writes a result as JSON to where the options say. A file appears whole or not at all; NaN becomes null.
void write_json(const nlohmann::ordered_json& result, const CommonOptions& options);

/// True where text for people is wanted on standard output.
bool wants_text(const CommonOptions& options);

/// A sub-command: adds itself to the program, and returns what to run when it was asked for.
using AddCommand = std::function<void()> (*)(CLI::App& program);

std::function<void()> add_process(CLI::App& program);
std::function<void()> add_effects(CLI::App& program);

}  // namespace pcor::tool
