#include "model_io/archived_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/realtime/chain.hpp>
#include "model_io/calibration.hpp"

namespace pcor::internal {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

bool is_heading(const std::string& line) { return line.front() == '[' || line.compare(0, 3, "id ") == 0; }

}  // namespace

std::string archived_model(const ModelDefinition& model, CorrectWith correct_with) {
  ModelDefinition bare = without_calibration(model);
  if (correct_with == CorrectWith::model) {
    bare.variables.erase(Quantity::lams_airspeed);
    bare.model.lams = {};
  }
  BindingError why;
  const std::optional<Chain> chain = Chain::build(bare.model, bare.roles(), &why);
  if (!chain) throw Error(Error::Code::model, fmt::format("model '{}': {}", model.model.name, why.message()));

  ModelDefinition result;
  result.model = bare.model;
  result.model.name = correct_with == CorrectWith::model ? "corrected with the law" : "corrected with LAMS";
  result.model.aircraft.clear();
  result.model.domain.clear();
  result.recovery_factor_name = bare.recovery_factor_name;
  const std::vector<std::string>& in_formulas = chain->extra_names();
  for (const auto& [role, variable] : bare.variables) {
    const bool counts = chain->needs(role) || is_always_read(role) || role == Quantity::static_pressure ||
                        role == Quantity::dynamic_pressure ||
                        std::find(in_formulas.begin(), in_formulas.end(), variable) != in_formulas.end();
    if (!counts) continue;
    result.variables[role] = variable;
    if (const auto unit = bare.units.find(role); unit != bare.units.end()) result.units[role] = unit->second;
  }
  return write_model(result);
}

std::string archived_difference(const std::string& archived, const std::string& given) {
  const std::vector<std::string> there = lines_of(archived);
  const std::vector<std::string> here = lines_of(given);
  if (there == here) return "";
  std::string heading;
  std::size_t i = 0;
  while (i < there.size() && i < here.size() && there[i] == here[i]) {
    if (is_heading(there[i])) heading = there[i];
    ++i;
  }
  const auto at = [i](const std::vector<std::string>& lines) {
    return i < lines.size() ? lines[i] : std::string("nothing");
  };
  return fmt::format("{}{}{} in the file, {} in the model", heading, heading.empty() ? "" : ": ", at(there),
                     at(here));
}

}  // namespace pcor::internal
