#include "model_io/model_names.hpp"

#include <algorithm>

namespace pcor::internal {

std::vector<NamedParameter> named_parameters(const Model& model) {
  std::vector<NamedParameter> all;
  for (std::size_t e = 0; e < model.effects.size(); ++e) {
    const Names names = parameter_names(model.effects[e]);
    for (std::size_t i = 0; i < names.size(); ++i)
      all.push_back({model.effects[e].id + "." + names[i], e, i});
  }
  return all;
}

double parameter_value(const Model& model, std::string_view name) {
  for (const NamedParameter& each : named_parameters(model)) {
    if (each.name == name) return model.effects[each.effect].parameters[each.number];
  }
  return 0.0;
}

Quantity role_of_variable(const ModelDefinition& file, std::string_view name) {
  if (quantity_named(name) != Quantity::count) return Quantity::count;
  const auto found = std::find_if(file.variables.begin(), file.variables.end(),
                                  [name](const auto& entry) { return entry.second == name; });
  return found == file.variables.end() ? Quantity::count : found->first;
}

const PublishedRecoveryFactor* published_recovery_factor(std::string_view name) {
  for (const PublishedRecoveryFactor& law : published_recovery_factors) {
    if (law.name == name) return &law;
  }
  return nullptr;
}

}  // namespace pcor::internal
