#include "processes.hpp"

#include <fmt/format.h>

#include <charconv>
#include <string_view>
#include <system_error>

#include "team.hpp"

namespace pcor::tool {
namespace {

constexpr std::string_view option = "--processes";
constexpr std::size_t most_processes = 1024;

/// The number that a word is, of those that are allowed; 0 where it is none.
std::size_t processes_in(std::string_view word) {
  std::size_t count = 0;
  const auto [rest, status] = std::from_chars(word.data(), word.data() + word.size(), count);
  const bool is_number = status == std::errc{} && rest == word.data() + word.size();
  return is_number && count <= most_processes ? count : 0;
}

std::string trouble_with(const std::string& word) {
  const std::size_t count = processes_in(word);
  if (count == 0) return fmt::format("{} is no number from 1 to {}", word, most_processes);
  if (count != team().size())
    return fmt::format(
        "is for pcor alone; the command that begins pcor_mpi says how many processes there are");
  return "";
}

}  // namespace

void add_processes_option(CLI::App& command) {
  command
      .add_option_function<std::string>(
          std::string(option), [](const std::string&) {},
          "as many processes of this machine share the flights, and read them at the same time; the result "
          "is the "
          "same")
      ->check(CLI::Validator(trouble_with, ""))
      ->type_name("N")
      ->default_str("1");
}

std::size_t processes_wanted(const std::vector<std::string>& words) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    if (word == option && i + 1 < words.size()) count = processes_in(words[i + 1]);
    if (word.substr(0, option.size() + 1) == std::string(option) + "=")
      count = processes_in(word.substr(option.size() + 1));
  }
  return count > 0 ? count : 1;
}

}  // namespace pcor::tool
