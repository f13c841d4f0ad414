#include "flight/absent_variable.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include <pcor/base/shell_quote.hpp>
#include <pcor/base/suggest.hpp>
#include <pcor/units/units.hpp>

#include "base/quoting.hpp"

namespace pcor::internal {
namespace {

// UDUNITS treats an angle as a plain number, so a count would convert to it.
bool is_angle(const std::string& unit) {
  const std::string standard = standard_unit(unit);
  return (standard.rfind("deg", 0) == 0 || standard.rfind("rad", 0) == 0) && is_convertible(unit, "radian");
}

bool begins_alike(const std::string& a, const std::string& b) {
  constexpr std::size_t letters = 2;
  return a.compare(0, letters, b, 0, letters) == 0;
}

// Number of words of a role ("recovery_temperature") in a text, without regard to case.
int shared_words(const std::string& role, const std::string& text) {
  const auto is_same_letter = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  int shared = 0;
  for (auto word = role.begin(); word != role.end();) {
    const auto end = std::find(word, role.end(), '_');
    if (std::search(text.begin(), text.end(), word, end, is_same_letter) != text.end()) ++shared;
    word = end == role.end() ? end : end + 1;
  }
  return shared;
}

}  // namespace

Error missing_variable(const std::string& path, const std::vector<VariableInfo>& series,
                       const std::string& name, const std::string& requested, const std::string& role) {
  std::vector<const VariableInfo*> fitting;
  std::vector<std::string> namesakes;
  for (const VariableInfo& each : series) {
    if (!is_convertible(each.units, requested) || is_angle(each.units) != is_angle(requested)) continue;
    fitting.push_back(&each);
    if (begins_alike(each.name, name)) namesakes.push_back(each.name);
  }
  const std::vector<std::string> alike = suggest(name, namesakes);
  const std::string shown = shortened(name);
  if (!alike.empty())
    return {Error::Code::variable,
            fmt::format("{}: {} is not in this file; it has {}; change {} in the [variables] of the model",
                        path, shown, fmt::join(alike, ", "), role)};
  const std::string absent = fmt::format("{}: {} ({} of the model) is not in this file", path, shown, role);
  if (fitting.empty())
    return {
        Error::Code::variable,
        fmt::format("{}; it has no time series in {} or a unit that converts to it, see ncdump -h {}; change "
                    "[variables] of the model",
                    absent, requested, shell_path(path))};

  constexpr std::size_t max_named = 6;
  // Files call the temperature of the recovery probe "total".
  const std::string words = role == "recovery_temperature" ? role + "_total" : role;
  std::stable_sort(fitting.begin(), fitting.end(), [&](const VariableInfo* a, const VariableInfo* b) {
    return shared_words(words, a->long_name) > shared_words(words, b->long_name);
  });
  const std::size_t others = fitting.size() - std::min(fitting.size(), max_named);
  fitting.resize(fitting.size() - others);
  std::string named;
  for (std::size_t i = 0; i < fitting.size(); ++i) {
    named += (i == 0 ? "" : ", ") + fitting[i]->name;
    const bool unit_changes =
        i + 1 == fitting.size() || standard_unit(fitting[i]->units) != standard_unit(fitting[i + 1]->units);
    if (unit_changes) named += " in " + standard_unit(fitting[i]->units);
  }
  if (others > 0) named += fmt::format(" and {} more", others);
  return {Error::Code::variable,
          fmt::format("{}; it has {} (units that fit); change [variables] of the model", absent, named)};
}

}  // namespace pcor::internal
