#include "processes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>

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

bool can_begin_processes = false;  // as pcor does, and pcor_mpi does not

std::string trouble_with(const std::string& word) {
  if (!can_begin_processes)
    return "is for pcor alone; mpirun or the like says how many processes pcor_mpi has";
  if (processes_in(word) == 0) return fmt::format("{} is no number from 1 to {}", word, most_processes);
  return "";
}

/// How many words, from this one on, are the option: 0, 1 or 2.
std::size_t length_of_option(const std::vector<std::string>& words, std::size_t place) {
  if (words[place] == option) return std::min<std::size_t>(2, words.size() - place);
  return words[place].compare(0, option.size() + 1, std::string(option) + "=") == 0 ? 1 : 0;
}

}  // namespace

void add_processes_option(CLI::App& command) {
  command
      .add_option_function<std::string>(
          std::string(option), [](const std::string&) {},
          "share the flights between N processes of this machine, which read at the same time; the result is "
          "the same")
      ->check(CLI::Validator(trouble_with, ""))
      ->type_name("N")
      ->default_str("1");
}

std::size_t processes_to_begin(const std::vector<std::string>& words) {
  can_begin_processes = true;
  std::size_t count = 1;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::size_t length = length_of_option(words, i);
    if (length == 0) continue;
    const std::string_view last = words[i + length - 1];
    count = processes_in(length == 1 ? last.substr(std::min(last.size(), option.size() + 1)) : last);
  }
  return std::max<std::size_t>(count, 1);
}

std::vector<std::string> without_processes(const std::vector<std::string>& words) {
  std::vector<std::string> kept;
  for (std::size_t i = 0; i < words.size();) {
    const std::size_t length = length_of_option(words, i);
    if (length == 0) kept.push_back(words[i]);
    i += std::max<std::size_t>(length, 1);
  }
  return kept;
}

}  // namespace pcor::tool
