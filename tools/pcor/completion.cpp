#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <string>
#include <string_view>
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

/// Escaped text in the specification of an option for zsh.
std::string zsh_text(const std::string& text) {
  std::string result;
  for (const char letter : text) {
    if (std::string_view("\\:[]").find(letter) != std::string_view::npos) result += '\\';
    result += letter;
  }
  return result;
}

/// First words of a description: text after a semicolon or a colon appears in the help only.
std::string brief(const CLI::Option& option) {
  const std::string& text = option.get_description();
  return text.substr(0, text.find_first_of(";:"));
}

std::string zsh_values(const CLI::Option& option) {
  const Offer offer = offer_of(option);
  std::vector<std::string> words;
  for (const std::string& word : offer.words)
    words.push_back(CLI::detail::find_and_replace(zsh_text(word), " ", "\\ "));
  const std::string action = !words.empty()        ? fmt::format("({})", fmt::join(words, " "))
                             : offer.files.empty() ? " "
                                                   : fmt::format("_files -g \"{}\"", offer.files);
  return fmt::format(":{}:{}", zsh_text(value_name(option)), action);
}

std::string zsh_arguments(const CLI::App& command) {
  std::string text;
  for (const CLI::Option* option : shown_options(command)) {
    const std::vector<std::string> names = names_of(*option);
    const bool repeats = option->get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
    for (const std::string& name : names) {
      const std::string others = repeats ? "*" : fmt::format("({})", fmt::join(names, " "));
      const std::string value = value_name(*option).empty() ? "" : zsh_values(*option);
      text += fmt::format(" \\\n        {}",
                          quote(fmt::format("{}{}[{}]{}", others, name, zsh_text(brief(*option)), value)));
    }
  }
  const CLI::Option* const positional = positional_of(command);
  if (positional != nullptr) {
    text += fmt::format(" \\\n        {}", quote((positional->get_items_expected_max() > 1 ? "*" : "1") +
                                                 zsh_values(*positional)));
  }
  return text;
}

std::string zsh_completion(const CLI::App& program) {
  std::string commands;
  std::string cases;
  for (const CLI::App* command : shown_commands(program)) {
    commands += fmt::format("        {}\n", quote(command->get_name() + ":" + command->get_description()));
    cases += fmt::format("      {}) _arguments{} ;;\n", command->get_name(), zsh_arguments(*command));
  }
  return fmt::format(R"(#compdef pcor
# Completion of pcor for zsh, written by 'pcor completion zsh'.
_pcor() {{
  local curcontext=$curcontext state line
  local -a commands
  _arguments -C{} '1:sub-command:->command' '*::argument:->argument'
  case $state in
    command)
      commands=(
{}      )
      _describe sub-command commands ;;
    argument)
      case $words[1] in
{}      esac ;;
  esac
}}
_pcor "$@"
)",
                     zsh_arguments(program), commands, cases);
}

/// `text` in single quotes for fish.
std::string in_fish_quotes(const std::string& text) {
  return "'" + CLI::detail::find_and_replace(CLI::detail::find_and_replace(text, "\\", "\\\\"), "'", "\\'") +
         "'";
}

/// Completion for fish: the arguments of its `complete`.
std::string fish_offer(const Offer& offer) {
  if (!offer.words.empty()) {
    std::vector<std::string> words;
    for (const std::string& word : offer.words) words.push_back(in_fish_quotes(word));
    return fmt::format(" -fa {}", in_fish_quotes(fmt::format("{}", fmt::join(words, " "))));
  }
  if (offer.files.empty()) return "";
  if (offer.files == "*") return " -F";
  if (offer.files == "*/") return " -fa '(__fish_complete_directories)'";
  return fmt::format(" -fka '(__fish_complete_suffix {})'", offer.files.substr(offer.files.find('.')));
}

std::string fish_completion(const CLI::App& program) {
  std::string text =
      "# Completion of pcor for fish, written by 'pcor completion fish'.\n"
      "complete -c pcor -f\n";
  const auto add_options = [&text](const CLI::App& of, const std::string& where) {
    for (const CLI::Option* option : shown_options(of)) {
      text += "complete -c pcor -n " + where;
      for (const std::string& name : names_of(*option))
        text += name[1] == '-' ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (!value_name(*option).empty()) text += " -r" + fish_offer(offer_of(*option));
      text += " -d " + in_fish_quotes(brief(*option)) + "\n";
    }
  };
  add_options(program, "__fish_use_subcommand");
  for (const CLI::App* command : shown_commands(program)) {
    const std::string& name = command->get_name();
    text += fmt::format("complete -c pcor -n __fish_use_subcommand -a {} -d {}\n", name,
                        in_fish_quotes(command->get_description()));
    const std::string where = in_fish_quotes("__fish_seen_subcommand_from " + name);
    add_options(*command, where);
    if (const CLI::Option* const positional = positional_of(*command))
      text += fmt::format("complete -c pcor -n {}{}\n", where, fish_offer(offer_of(*positional)));
  }
  return text;
}

}  // namespace

std::function<void()> add_completion(CLI::App& program) {
  auto shell = std::make_shared<std::string>();
  CLI::App* command = program.add_subcommand("completion", "Print the completion script of a shell");
  command->group("");  // hidden in the help, because it is for packagers
  command->add_option("shell", *shell, "the shell")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  return [shell, &program] {
    fmt::print("{}", *shell == "bash"  ? bash_completion(program)
                     : *shell == "zsh" ? zsh_completion(program)
                                       : fish_completion(program));
  };
}

}  // namespace pcor::tool
