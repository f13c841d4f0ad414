#include "processes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>

namespace pcor::tool {
namespace {

constexpr std::string_view option = "--processes";
constexpr std::size_t max_processes = 1024;

/// Number in a word, within the allowed range; 0 if invalid.
std::size_t processes_in(std::string_view word) {
  std::size_t count = 0;
  const auto [rest, status] = std::from_chars(word.data(), word.data() + word.size(), count);
  const bool is_number = status == std::errc{} && rest == word.data() + word.size();
  return is_number && count <= max_processes ? count : 0;
}

bool may_copy_itself = false;  // true in pcor, which starts the requested number of processes

std::string trouble_with(const std::string& word) {
  if (!may_copy_itself)
    return "is supported by pcor only; pcor_mpi uses the number of processes given to mpirun or srun";
  if (processes_in(word) == 0) return fmt::format("{} is not a number from 1 to {}", word, max_processes);
  return "";
}

/// Command line in two parts.
struct Parted {
  std::string number{};  // word after the option; the last of several
  std::vector<std::string> rest{};
};

Parted parted(const std::vector<std::string>& words) {
  const std::string with_number = std::string(option) + "=";
  Parted result;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == option) {
      if (++i < words.size()) result.number = words[i];
    } else if (words[i].compare(0, with_number.size(), with_number) == 0) {
      result.number = words[i].substr(with_number.size());
    } else {
      result.rest.push_back(words[i]);
    }
  }
  return result;
}

}  // namespace

void add_processes_option(CLI::App& command) {
  command
      .add_option_function<std::string>(
          std::string(option), [](const std::string&) {},
          "process flights in N parallel processes (the result does not depend on N)")
      ->check(CLI::Validator(trouble_with, ""))
      ->type_name("N")
      ->default_str("1");
}

std::size_t processes_to_begin(const std::vector<std::string>& words) {
  may_copy_itself = true;
  return std::max<std::size_t>(processes_in(parted(words).number), 1);
}

std::vector<std::string> without_processes(const std::vector<std::string>& words) {
  return parted(words).rest;
}

}  // namespace pcor::tool
