#include "roles/recorded_model.hpp"

#include <algorithm>
#include <iterator>

#include "model_io/model_names.hpp"
#include "roles/recorded_series.hpp"

namespace pcor::internal {

std::vector<PressurePair> measured_pairs(const Flight& flight) {
  const VariableNaming& naming = naming_of(flight);
  std::vector<PressurePair> pairs;
  std::copy_if(naming.measured.begin(), naming.measured.end(), std::back_inserter(pairs),
               [&](const PressurePair& pair) { return has_values(flight, naming, pair); });
  return pairs;
}

ModelDefinition model_of(const PressurePair& pair) {
  ModelDefinition model;
  model.model.name = pair.name() + " as recorded";
  model.variables[Quantity::static_pressure] = pair.static_pressure;
  model.variables[Quantity::dynamic_pressure] = pair.dynamic_pressure;
  return model;
}

std::optional<ModelDefinition> recorded_model(const Flight& flight) {
  const VariableNaming& naming = naming_of(flight);
  const PressurePair* pair = first_with_values(flight, naming, naming.processed);
  if (pair == nullptr) pair = first_with_values(flight, naming, naming.measured);
  if (pair == nullptr) return std::nullopt;
  ModelDefinition model = model_of(*pair);
  const auto take = [&](Quantity role) {
    const std::string variable = first_with_values(flight, naming, info_of(role).name);
    if (!variable.empty()) model.variables[role] = variable;
    return !variable.empty();
  };
  if (!take(Quantity::ambient_temperature)) {
    if (const Thermometer* const thermometer = first_with_values(flight, naming, naming.thermometers)) {
      model.variables[Quantity::recovery_temperature] = thermometer->variable;
      model.model.recovery = published_recovery_factor(thermometer->recovery)->law;
    }
  }
  model.model.moist = std::any_of(humidity_roles.begin(), humidity_roles.end(), take);
  return model;
}

}  // namespace pcor::internal
