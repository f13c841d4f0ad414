#include "flight/missing_variable.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <cstring>

#include <pcor/base/shell_quote.hpp>
#include <pcor/base/suggest.hpp>
#include <pcor/units/units.hpp>
#include "base/phrasing.hpp"
#include "base/quoting.hpp"
#include "flight/called_corrected.hpp"

namespace pcor::internal {
namespace {

/// UDUNITS treats an angle as a plain number, so a count would convert to it.
bool is_angle(const std::string& unit) {
  const std::string standard = standard_unit(unit);
  return (standard.rfind("deg", 0) == 0 || standard.rfind("rad", 0) == 0) && is_convertible(unit, "radian");
}

/// Number of words of a role ("recovery_temperature") in a text, without regard to case.
std::ptrdiff_t shared_words(std::string role, const std::string& text) {
  std::replace(role.begin(), role.end(), '_', ' ');
  const std::vector<std::string> words = split_words(role);
  return std::count_if(words.begin(), words.end(), [&text](const std::string& word) {
    return strcasestr(text.c_str(), word.c_str()) != nullptr;
  });
}

}  // namespace

void refuse_missing(const FlightFile& file, const std::vector<VariableInfo>& variables,
                    const std::string& name, const std::string& requested, const std::string& role) {
  std::vector<const VariableInfo*> fitting;
  std::vector<std::string> namesakes;
  std::vector<std::string> corrected;  // pressures that a law would correct a second time
  // The unit of a ratio is that of many other variables.
  const bool is_ratio = is_convertible(requested, "1") && !is_angle(requested);
  // Files call the temperature of the recovery probe "total".
  const std::string words = role == "recovery_temperature" ? role + "_total" : role;
  for (const VariableInfo& each : variables) {
    if (!each.is_series || !is_convertible(each.units, requested) ||
        is_angle(each.units) != is_angle(requested))
      continue;
    const bool is_namesake = each.name.compare(0, 2, name, 0, 2) == 0;
    if (requested == "hPa" && is_called_corrected(each.long_name)) {
      if (is_namesake) corrected.push_back(each.name);
      continue;
    }
    if (!is_ratio || is_namesake || shared_words(words, each.long_name) > 0) fitting.push_back(&each);
    if (is_namesake) namesakes.push_back(each.name);
  }
  const std::vector<std::string> similar = suggest(name, namesakes);
  const std::string shown = shortened(name);
  if (!similar.empty())
    file.refuse(Error::Code::variable,
                ": {} is not in this file; it has {}; if that is the same measurement, change {} in the "
                "[variables] of the model that names it",
                shown, fmt::format("{}", fmt::join(similar, ", ")), role);
  const bool has_raw = std::any_of(fitting.begin(), fitting.end(), [&](const VariableInfo* each) {
    return shared_words(words, each->long_name) > 1 && shared_words("raw", each->long_name) > 0;
  });
  if ((!corrected.empty() && !has_raw) || (fitting.empty() && is_ratio))
    file.refuse(Error::Code::variable,
                ": {} ({} of the model) is not in this file{}; give another model for this flight, see "
                "pcor inspect {}",
                shown, role,
                corrected.empty()
                    ? ""
                    : fmt::format("; it has only {}, already corrected", fmt::join(corrected, ", ")),
                shell_path(file.path().string()));
  if (fitting.empty())
    file.refuse(Error::Code::variable,
                ": {} ({} of the model) is not in this file; it has no time series in {} or a unit that "
                "converts to it, see ncdump -h {}; change [variables] of the model",
                shown, role, requested, shell_path(file.path().string()));

  constexpr std::size_t max_named = 6;
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
  file.refuse(Error::Code::variable,
              ": {} ({} of the model) is not in this file; it has {} (units that fit); change [variables] of "
              "the model",
              shown, role, named);
}

}  // namespace pcor::internal
