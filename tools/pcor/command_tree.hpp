#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace pcor::tool {

/// Sub-commands shown by the help.
std::vector<const CLI::App*> shown_commands(const CLI::App& program);

/// Options shown by the help of a command, without its positional arguments.
std::vector<const CLI::Option*> shown_options(const CLI::App& command);

/// Positional argument of a command; null if there is no such argument.
const CLI::Option* positional_of(const CLI::App& command);

/// Names of an option as written on a command line: "-m", "--model".
std::vector<std::string> names_of(const CLI::Option& option);

/// Value name of an option in the help: "MODEL.toml", "NUMBER", "begin|middle"; empty for a flag.
std::string value_name(const CLI::Option& option);

/// Completions of the value of an option.
struct Offer {
  std::vector<std::string> words{};  ///< complete list of words
  std::string
      files{};  ///< otherwise files of this pattern, such as "*.nc", "*/" for folders; empty without files
};

Offer offer_of(const CLI::Option& option);

}  // namespace pcor::tool
