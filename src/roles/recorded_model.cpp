#include "roles/recorded_model.hpp"

#include <algorithm>

#include "model_io/model_names.hpp"
#include "roles/recorded_series.hpp"

namespace pcor::internal {
namespace {

bool has_role(const Flight& flight, const std::string& variable, Quantity role) {
  return has_values(flight, variable, std::string(info_of(role).unit));
}

/// Gives the model the first of the usual variables that has values; false if no variable has values.
bool add_usual(const Flight& flight, Quantity role, ModelDefinition& model) {
  const std::vector<std::string> names = family_of(flight).names_of(info_of(role).name);
  const auto found = std::find_if(names.begin(), names.end(),
                                  [&](const std::string& name) { return has_role(flight, name, role); });
  if (found == names.end()) return false;
  model.variables[role] = *found;
  return true;
}

void add_thermometer(const Flight& flight, ModelDefinition& model) {
  for (const Thermometer& thermometer : family_of(flight).thermometers) {
    if (!has_role(flight, thermometer.variable, Quantity::recovery_temperature)) continue;
    model.variables[Quantity::recovery_temperature] = thermometer.variable;
    model.model.recovery = published_recovery_factor(thermometer.recovery)->law;
    return;
  }
}

std::vector<PressurePair> pairs_in(const Flight& flight, const std::vector<PressurePair>& known) {
  std::vector<PressurePair> pairs;
  std::copy_if(known.begin(), known.end(), std::back_inserter(pairs), [&](const PressurePair& pair) {
    return has_role(flight, pair.static_pressure, Quantity::static_pressure) &&
           has_role(flight, pair.dynamic_pressure, Quantity::dynamic_pressure);
  });
  return pairs;
}

}  // namespace

std::vector<PressurePair> measured_pairs(const Flight& flight) {
  return pairs_in(flight, family_of(flight).measured);
}

ModelDefinition model_of(const PressurePair& pair) {
  ModelDefinition model;
  model.model.name = pair.name() + " as recorded";
  model.variables[Quantity::static_pressure] = pair.static_pressure;
  model.variables[Quantity::dynamic_pressure] = pair.dynamic_pressure;
  return model;
}

std::optional<ModelDefinition> recorded_model(const Flight& flight) {
  std::vector<PressurePair> pairs = pairs_in(flight, family_of(flight).processed);
  if (pairs.empty()) pairs = measured_pairs(flight);
  if (pairs.empty()) return std::nullopt;
  ModelDefinition model = model_of(pairs.front());
  if (!add_usual(flight, Quantity::ambient_temperature, model)) add_thermometer(flight, model);
  model.model.moist =
      add_usual(flight, Quantity::vapor_pressure, model) || add_usual(flight, Quantity::dew_point, model);
  return model;
}

}  // namespace pcor::internal
