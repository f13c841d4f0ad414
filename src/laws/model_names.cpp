#include "laws/model_names.hpp"

namespace pcor::internal {

Names names_of_parameters(const EffectFacts& facts) {
  Names names = names_of(facts.parameters, &ParameterFacts::name);
  names.resize(facts.parameter_count());
  return names;
}

const PublishedRecoveryFactor* published_recovery_factor(std::string_view name) {
  for (const PublishedRecoveryFactor& law : published_recovery_factors) {
    if (law.name == name) return &law;
  }
  return nullptr;
}

}  // namespace pcor::internal
