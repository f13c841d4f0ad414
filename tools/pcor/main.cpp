#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <functional>
#include <string>
#include <system_error>
#include <vector>

#include <pcor/words/error.hpp>
#include <pcor/words/replacement_file.hpp>
#include <pcor/words/suggest.hpp>

#include "commands.hpp"
#include "model_name.hpp"
#include "report_origin.hpp"

namespace {

constexpr int work_not_done = 1;
constexpr int wrong_usage = 2;

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string with_hint(const std::string& message, const std::string& hint, const std::string& help) {
  return fmt::format("pcor: {};{}{} '{}' lists them", message, hint.empty() ? "" : " ", hint, help);
}

/// The long options of a command line that `command` does not have.
std::vector<std::string> unknown_options(const CLI::App& command, const std::vector<std::string>& words,
                                         std::vector<std::string>& known) {
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  std::vector<std::string> unknown;
  for (const std::string& word : words) {
    const std::string name = word.substr(0, word.find('='));
    if (name.rfind("--", 0) == 0 && name != "--" && !contains(known, name)) unknown.push_back(name);
  }
  return unknown;
}

/// One line about a usage error: what was wrong, what may have been meant, and where all is listed.
std::string usage_message(const CLI::App& program, const std::string& message,
                          const std::vector<std::string>& words) {
  if (words.empty()) return "pcor: no sub-command; 'pcor --help' lists them";
  std::vector<std::string> names;
  const CLI::App* command = nullptr;
  for (const CLI::App* each : program.get_subcommands({})) {
    names.push_back(each->get_name());
    if (each->get_name() == words.front()) command = each;
  }
  if (command == nullptr && words.front()[0] != '-') {
    return with_hint(fmt::format("there is no sub-command '{}'", words.front()),
                     pcor::did_you_mean(words.front(), names), "pcor --help");
  }
  const std::string help = command == nullptr ? "pcor --help" : "pcor " + words.front() + " --help";
  std::vector<std::string> known;
  const std::vector<std::string> unknown =
      unknown_options(command == nullptr ? program : *command, words, known);
  if (!unknown.empty()) {
    return with_hint(fmt::format("there is no option '{}'", unknown.front()),
                     pcor::did_you_mean(unknown.front(), known), help);
  }
  return fmt::format("pcor: {}; '{}' lists the options", message, help);
}

/// Leaves nothing unfinished behind when the program is stopped.
extern "C" void stop(int signal) {
  pcor::remove_unfinished_files();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

}  // namespace

int main(int argc, char** argv) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, stop);

  pcor::tool::remember_command(argc, argv);
  CLI::App program("Corrects the static and dynamic pressure that a research aircraft measures.", "pcor");
  program.set_version_flag("--version", "pcor " PCOR_VERSION);
  program.require_subcommand(1);
  program.footer(
      "delta-p: the correction, hPa, that is added to the static pressure and taken off the dynamic "
      "pressure.\n"
      "LAMS: the laser air-motion sensor, which measures the airspeed ahead of the aircraft.\n"
      "Further words: docs/glossary.md.\n\n"
      "Exit status: 0 done, 1 the work could not be done, 2 usage.");

  std::vector<std::function<void()>> runs;
  for (const auto add : pcor::tool::commands) runs.push_back(add(program));
  pcor::tool::take_models_by_name(program);

  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return program.exit(success);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "{}\n", usage_message(program, error.what(), {argv + 1, argv + argc}));
    return wrong_usage;
  } catch (const pcor::Error& error) {
    fmt::print(stderr, "pcor: {}\n", error.what());
    return work_not_done;
  }

  try {
    const auto all = program.get_subcommands({});
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i]->parsed()) runs[i]();
    }
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      throw pcor::Error("standard output: cannot be written; check the space where it goes");
    }
  } catch (const pcor::Error& error) {
    fmt::print(stderr, "pcor: {}\n", error.what());
    return work_not_done;
  } catch (const std::system_error& error) {
    // fmt::print throws it where the text does not go out.
    fmt::print(stderr, "pcor: standard output: {}; check the space where it goes\n", error.code().message());
    return work_not_done;
  } catch (const std::exception& error) {
    fmt::print(stderr, "pcor: a fault of the program itself, please report it: {}\n", error.what());
    return work_not_done;
  }
  return 0;
}
