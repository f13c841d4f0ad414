#include "model_io/model_names.hpp"

namespace pcor::internal {

Names names_of_parameters(const EffectInfo& info) {
  Names names = names_of(info.parameters, &ParameterInfo::name);
  names.resize(info.parameter_count());
  return names;
}

const double* parameter_named(const Model& model, std::string_view name) {
  for (const ModelEffect& effect : model.effects) {
    const Names names = parameter_names(effect);
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
      if (effect.id + "." + names[i] == name) return &effect.parameters[i];
    }
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
