#include "usage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include <pcor/base/suggest.hpp>
#include "command_tree.hpp"
#include "text.hpp"

namespace pcor::tool {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Names that users try, and what does their work.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> other_names{{
    {"--figures", "pcor-figures"},
    {"--processes", "pcor_mpi"},
    {"--html", "--report"},
    {"--plot", "--report"},
    {"--from", "--intervals"},
    {"--start", "--intervals"},
    {"--end", "--intervals"},
    {"evaluate", "compare"},
}};

std::string hint_of(const std::string& wrong, const std::vector<std::string>& known) {
  for (const auto& [other, meant] : other_names) {
    if (wrong == other && (meant[0] != '-' || contains(known, std::string(meant))))
      return fmt::format("did you mean {}?", meant);
  }
  return did_you_mean(wrong, known);
}

std::string with_hint(const std::string& message, const std::string& hint, const std::string& help) {
  return fmt::format("pcor: {};{}{} to list them: {}", message, hint.empty() ? "" : " ", hint, help);
}

/// Long options of a command line that `command` does not have.
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

bool is_option(const std::string& word) { return word.size() > 1 && word[0] == '-'; }

/// True if the word after `word` is its value.
bool takes_next(const CLI::App& command, const std::string& word) {
  if (!is_option(word) || word.find('=') != std::string::npos) return false;
  const CLI::Option* const option = command.get_option_no_throw(word);
  return option != nullptr && option->get_items_expected_max() > 0;
}

/// Sub-command named by the first word of a command line; null if it does not exist.
const CLI::App* command_of(const CLI::App& program, const std::vector<std::string>& words) {
  for (const CLI::App* each : program.get_subcommands({})) {
    if (!words.empty() && each->get_name() == words.front()) return each;
  }
  return nullptr;
}

}  // namespace

std::string usage_message(const CLI::App& program, const std::string& message,
                          const std::vector<std::string>& words) {
  const std::string help_of_all = tool::program() + " --help";
  if (words.empty()) return fmt::format("pcor: no sub-command; to list them: {}", help_of_all);
  const CLI::App* const command = command_of(program, words);
  if (command == nullptr && words.front()[0] != '-') {
    std::vector<std::string> names;
    for (const CLI::App* each : shown_commands(program)) names.push_back(each->get_name());
    return with_hint(fmt::format("unknown sub-command '{}'", words.front()), hint_of(words.front(), names),
                     help_of_all);
  }
  const std::string help =
      command == nullptr ? help_of_all : fmt::format("{} {} --help", tool::program(), words.front());
  std::vector<std::string> known;
  const std::vector<std::string> unknown =
      unknown_options(command == nullptr ? program : *command, words, known);
  if (!unknown.empty()) {
    return with_hint(fmt::format("unknown option '{}'", unknown.front()), hint_of(unknown.front(), known),
                     help);
  }
  return fmt::format("pcor: {}; to list the options: {}", message, help);
}

std::string flights_behind_holdout(const CLI::App& program, const std::vector<std::string>& words) {
  const CLI::App* const command = command_of(program, words);
  if (command == nullptr) return "";
  bool has_flight = false;
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (!takes_next(*command, words[i])) {
      has_flight = has_flight || !is_option(words[i]);
      continue;
    }
    const bool lists = words[i] == "--holdout" && i + 2 < words.size() && !is_option(words[i + 2]);
    if (lists && has_flight) {
      return fmt::format(
          "--holdout takes one value; '{1}' would be fitted, not held out. Repeat the option: --holdout {0} "
          "--holdout {1}",
          words[i + 1], words[i + 2]);
    }
    ++i;
  }
  return "";
}

}  // namespace pcor::tool
