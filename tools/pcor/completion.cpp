#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <vector>

#include "command.hpp"
#include "command_tree.hpp"

namespace pcor::tool {
namespace {

/// `text` in single quotes, for any content.
std::string quote(const std::string& text) {
  return "'" + CLI::detail::find_and_replace(text, "'", "'\\''") + "'";
}

/// Completion for bash: an assignment that the function below reads.
std::string bash_offer(const Offer& offer) {
  if (!offer.words.empty())
    return fmt::format("words={}", quote(fmt::format("{}", fmt::join(offer.words, "\n"))));
  return offer.files.empty() ? "return" : fmt::format("files={}", quote(offer.files));
}

/// Cases of one sub-command: the values of its options, its options, its positional arguments.
std::string bash_cases(const CLI::App& command) {
  std::string text;
  std::vector<std::string> options;
  for (const CLI::Option* option : shown_options(command)) {
    const std::vector<std::string> names = names_of(*option);
    options.insert(options.end(), names.begin(), names.end());
    if (value_name(*option).empty()) continue;
    std::vector<std::string> patterns;
    for (const std::string& name : names)
      patterns.push_back(quote(command.get_name() + " " + name + " ") + "*");
    text += fmt::format("    {}) {} ;;\n", fmt::join(patterns, " | "), bash_offer(offer_of(*option)));
  }
  const CLI::Option* const positional = positional_of(command);
  text += fmt::format("    {}*' -'*) {} ;;\n", quote(command.get_name() + " "), bash_offer({options, ""}));
  text += fmt::format("    {}*) {} ;;\n", quote(command.get_name() + " "),
                      positional == nullptr ? "return" : bash_offer(offer_of(*positional)));
  return text;
}

std::string bash_completion(const CLI::App& program) {
  std::vector<std::string> commands;
  std::string cases;
  for (const CLI::App* command : shown_commands(program)) {
    commands.push_back(command->get_name());
    cases += bash_cases(*command);
  }
  for (const CLI::Option* option : shown_options(program)) {
    const std::vector<std::string> names = names_of(*option);
    commands.insert(commands.end(), names.begin(), names.end());
  }
  // Bash also breaks words at '=' and ':': --option=value, static:OTHER.toml.
  return fmt::format(R"(# Completion of pcor for bash, written by 'pcor completion bash'.
_pcor() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} words='' files='' IFS=$'\n'
  if [[ $word == [=:] ]]; then before=$word word=''; fi
  if [[ $before == = ]]; then before=${{COMP_WORDS[COMP_CWORD-2]}}; fi
  if [[ $before == : ]]; then
    files='*.toml'
  elif ((COMP_CWORD == 1)); then
    {}
  else
    case "${{COMP_WORDS[1]}} $before $word" in
{}    esac
  fi
  # As file names, words are quoted; a colon must stay as it is.
  if [[ $words != *:* ]]; then compopt -o filenames 2>/dev/null; fi
  if [[ -n $words ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$word"))
    if [[ ${{COMPREPLY[0]}} == *: ]]; then compopt -o nospace 2>/dev/null; fi
  elif [[ -n $files ]]; then
    COMPREPLY=($(compgen -f -X "!$files" -- "$word") $(compgen -d -- "$word"))
  fi
}}
complete -F _pcor pcor
)",
                     bash_offer({commands, ""}), cases);
}

}  // namespace

std::function<void()> add_completion(CLI::App& program) {
  CLI::App* command = program.add_subcommand("completion", "Print the completion script of bash");
  command->group("");  // hidden in the help, because it is for packagers
  command
      ->add_option_function<std::string>(
          "shell", [](const std::string&) {}, "the shell")
      ->required()
      ->check(CLI::IsMember({"bash"}));
  return [&program] { fmt::print("{}", bash_completion(program)); };
}

}  // namespace pcor::tool
