#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace pcor::tool {

/// The sub-commands that the help shows.
std::vector<const CLI::App*> shown_commands(const CLI::App& program);

/// The options that the help of a command shows, without its positional arguments.
std::vector<const CLI::Option*> shown_options(const CLI::App& command);

/// The positional argument of a command; null where it has none.
const CLI::Option* positional_of(const CLI::App& command);

/// The names of an option as they are written: "-m", "--model".
std::vector<std::string> names_of(const CLI::Option& option);

/// What an option takes, in the words of the help: "MODEL.toml", "NUMBER", "begin|middle"; empty for a flag.
std::string value_name(const CLI::Option& option);

/// What a shell may offer as value of an option.
struct Offer {
  std::vector<std::string> words{};  ///< all there are
  std::string files{};  ///< else files of this pattern, such as "*.nc", "*/" for folders; empty for none
};

Offer offer_of(const CLI::Option& option);

}  // namespace pcor::tool
