#include "model_io/model_names.hpp"

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

const double* parameter_named(const Model& model, std::string_view name) {
  for (const NamedParameter& each : named_parameters(model)) {
    if (each.name == name) return &model.effects[each.effect].parameters[each.number];
  }
  return nullptr;
}

const PublishedRecoveryFactor* published_recovery_factor(std::string_view name) {
  for (const PublishedRecoveryFactor& law : published_recovery_factors) {
    if (law.name == name) return &law;
  }
  return nullptr;
}

}  // namespace pcor::internal
