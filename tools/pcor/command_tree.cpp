#include "command_tree.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include <pcor/effects/catalogue.hpp>
#include <pcor/regimes/regimes.hpp>
#include <pcor/residuals/reference.hpp>

namespace pcor::tool {
namespace {

/// Words in "TEXT:{begin,middle}"; empty if the option does not choose among words.
std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{');
  const std::size_t close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

/// Names of all `facts`, an array of elements with a name.
template <class Info, class Name>
std::vector<std::string> all_names(const Info& info, const Name& name) {
  std::vector<std::string> names;
  for (const auto& each : info) names.emplace_back(name(each));
  return names;
}

}  // namespace

std::vector<const CLI::App*> shown_commands(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

std::vector<const CLI::Option*> shown_options(const CLI::App& command) {
  return command.get_options(
      [](const CLI::Option* option) { return !option->get_group().empty() && option->nonpositional(); });
}

const CLI::Option* positional_of(const CLI::App& command) {
  const auto all = command.get_options([](const CLI::Option* option) { return option->get_positional(); });
  return all.empty() ? nullptr : all.front();
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

std::string value_name(const CLI::Option& option) {
  if (option.get_items_expected_max() == 0) return "";
  const std::vector<std::string> choices = choices_of(option);
  if (!choices.empty()) return fmt::format("{}", fmt::join(choices, "|"));
  const std::string type = option.get_type_name();
  if (type.empty()) return option.get_name();
  return type.rfind("FLOAT", 0) == 0 ? "NUMBER" : type;
}

Offer offer_of(const CLI::Option& option) {
  const std::vector<std::string> choices = choices_of(option);
  if (!choices.empty()) return {choices, ""};
  const std::string value = value_name(option);
  if (value == "REGIME")
    return {all_names(regime_info, [](const RegimeInfo& info) { return info.name; }), ""};
  if (value == "ID" || value == "EFFECT...")
    return {all_names(effect_info, [](const EffectInfo& info) { return info.id; }), ""};
  if (value == "REFERENCE") return {reference_beginnings(), ""};
  if (value == "static:OTHER.toml") return {{"static:"}, ""};
  if (value == "FILE") return {{}, "*"};
  if (value == "FOLDER") return {{}, "*/"};
  const std::size_t dot = value.rfind('.');
  return {{}, dot == std::string::npos ? "" : "*" + value.substr(dot)};
}

}  // namespace pcor::tool
