#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>
#include "command.hpp"
#include "command_tree.hpp"

namespace pcor::tool {
namespace {

constexpr std::size_t max_line = 78;

struct ManArguments {
  std::string command;
  std::string folder;
};

/// Word or name in troff: a hyphen remains one that can be copied.
std::string troff(const std::string& text) {
  std::string result;
  for (const char letter : text) {
    if (letter == '\\') {
      result += "\\e";
    } else if (letter == '-') {
      result += "\\-";
    } else {
      result += letter;
    }
  }
  return result;
}

/// Running text in short lines that are not requests.
std::string paragraph(const std::string& text) {
  std::string result;
  for (const std::string& line : CLI::detail::split(wrapped(troff(text), max_line), '\n')) {
    const std::string words = CLI::detail::trim_copy(line);
    result += (words[0] == '.' || words[0] == '\'' ? "\\&" : "") + words + "\n";
  }
  return result;
}

std::string bold(const std::string& text) { return "\\fB" + troff(text) + "\\fR"; }

/// A list of choices may be broken between them.
std::string italic(const std::string& text) {
  return "\\fI" + CLI::detail::find_and_replace(troff(text), "|", "|\\:") + "\\fR";
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  return text;
}

std::string title(const std::string& name, const std::string& description) {
  return fmt::format(".TH {} 1 " PCOR_DATE " \"pcor {}\" \"pcor\"\n.ad l\n.SH NAME\n{}", upper(name),
                     PCOR_VERSION, paragraph(name + " - " + description));
}

std::string option_entry(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : names_of(option)) names.push_back(bold(name));
  const std::string value = value_name(option);
  std::string text = option.get_description();
  if (option.get_required()) text += " (required)";
  if (!option.get_default_str().empty()) text += fmt::format(" (default: {})", option.get_default_str());
  return fmt::format(".TP\n{}{}{}\n{}", fmt::join(names, ", "), value.empty() ? "" : " ",
                     value.empty() ? "" : italic(value), paragraph(text));
}

std::string options_section(const CLI::App& command) {
  std::string text = ".SH OPTIONS\n";
  if (const CLI::Option* const positional = positional_of(command))
    text +=
        fmt::format(".TP\n{}\n{}", italic(value_name(*positional)), paragraph(positional->get_description()));
  for (const CLI::Option* option : shown_options(command)) text += option_entry(*option);
  return text;
}

/// End of the help: words, one per line, and examples.
std::string closing_sections(const CLI::App& command) {
  const std::string footer = command.get_footer();
  const std::size_t heading = footer.find(examples_heading);
  std::string notes;
  for (const std::string& line : CLI::detail::split(footer.substr(0, heading), '\n'))
    if (!line.empty()) notes += (notes.empty() ? "" : ".PP\n") + paragraph(line);
  const std::string text = ".SH NOTES\n" + notes;
  if (heading == std::string::npos) return text;
  const std::string examples = footer.substr(heading + std::string(examples_heading).size());
  return text + fmt::format(".SH EXAMPLES\n.nf\n{}.fi\n", troff(examples));
}

std::string see_also(const std::vector<std::string>& pages) {
  std::vector<std::string> names;
  for (const std::string& page : pages) names.push_back(bold(page) + "(1)");
  return fmt::format(".SH SEE ALSO\n{}\n", fmt::join(names, ",\n"));
}

std::string page_of_command(const CLI::App& command) {
  const std::string name = "pcor-" + command.get_name();
  const CLI::Option* const positional = positional_of(command);
  return title(name, command.get_description()) +
         fmt::format(".SH SYNOPSIS\n{} [options]{}\n", bold("pcor " + command.get_name()),
                     positional == nullptr ? "" : " " + italic(value_name(*positional))) +
         options_section(command) + closing_sections(command) + see_also({"pcor"});
}

std::string page_of_program(const CLI::App& program) {
  std::string text =
      title("pcor", program.get_description()) +
      fmt::format(".SH SYNOPSIS\n{} {} [options]\n.SH COMMANDS\n", bold("pcor"), italic("command"));
  std::vector<std::string> pages;
  for (const CLI::App* command : shown_commands(program)) {
    text += fmt::format(".TP\n{}\n{}", bold(command->get_name()), paragraph(command->get_description()));
    pages.push_back("pcor-" + command->get_name());
  }
  return text + options_section(program) + closing_sections(program) + see_also(pages);
}

void write_page(const std::filesystem::path& path, const std::string& page) {
  std::ofstream stream(path, std::ios::binary);
  stream << page;
  stream.close();
  if (!stream)
    throw Error(Error::Code::output,
                fmt::format("{}: cannot be written; make its folder first", path.string()));
}

void run(const CLI::App& program, const ManArguments& options) {
  set_program("pcor");  // the examples assume an installed program
  if (!options.folder.empty()) {
    const std::filesystem::path folder = options.folder;
    write_page(folder / "pcor.1", page_of_program(program));
    for (const CLI::App* command : shown_commands(program))
      write_page(folder / ("pcor-" + command->get_name() + ".1"), page_of_command(*command));
    return;
  }
  if (options.command.empty()) {
    fmt::print("{}", page_of_program(program));
    return;
  }
  for (const CLI::App* command : shown_commands(program)) {
    if (command->get_name() != options.command) continue;
    fmt::print("{}", page_of_command(*command));
    return;
  }
  throw Error(
      Error::Code::usage,
      fmt::format("there is no manual page of '{}', because it is not a sub-command", options.command));
}

}  // namespace

std::function<void()> add_man(CLI::App& program) {
  auto options = std::make_shared<ManArguments>();
  CLI::App* command = program.add_subcommand("man", "Print a manual page in troff");
  command->group("");  // hidden in the help, because it is for packagers
  command->add_option("command", options->command, "sub-command (default: the page of the program)");
  command->add_option("--folder", options->folder, "write all pages into this folder")->type_name("FOLDER");
  return [options, &program] { run(program, *options); };
}

}  // namespace pcor::tool
