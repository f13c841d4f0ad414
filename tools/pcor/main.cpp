#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "command.hpp"
#include "pcor/offline/error.hpp"
#include "pcor/offline/suggest.hpp"

namespace {

constexpr int work_not_done = 1;
constexpr int wrong_usage = 2;

/// The message of a usage error, with the sub-command that may have been meant.
std::string usage_message(const CLI::App& program, const std::string& message, int argc, char** argv) {
  const std::string text = fmt::format("pcor: {}", message);
  if (argc < 2) return "pcor: no sub-command; 'pcor --help' lists them";
  if (argv[1][0] == '-') return text + "; 'pcor --help' lists the options";
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands({})) names.push_back(command->get_name());
  const bool known = std::find(names.begin(), names.end(), argv[1]) != names.end();
  if (known) return fmt::format("{}; 'pcor {} --help' lists the options", text, argv[1]);
  const std::string hint = pcor::did_you_mean(argv[1], names);
  return fmt::format("pcor: there is no sub-command '{}'{}{}; 'pcor --help' lists them", argv[1],
                     hint.empty() ? "" : ": ", hint);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program("Corrects the static and dynamic pressure that a research aircraft measures.", "pcor");
  program.set_version_flag("--version", "pcor " PCOR_VERSION);
  program.require_subcommand(1);
  program.footer("Exit status: 0 done, 1 the work could not be done, 2 usage.");

  constexpr std::array<pcor::tool::AddCommand, 2> commands{&pcor::tool::add_process,
                                                           &pcor::tool::add_effects};
  std::vector<std::function<void()>> runs;
  for (const auto add : commands) runs.push_back(add(program));

  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return program.exit(success);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "{}\n", usage_message(program, error.what(), argc, argv));
    return wrong_usage;
  }

  try {
    const auto all = program.get_subcommands({});
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i]->parsed()) runs[i]();
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "pcor: {}\n", error.what());
    return work_not_done;
  }
  return 0;
}
