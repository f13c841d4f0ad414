#include <pcor/fit/refit.hpp>

namespace pcor {

std::vector<FittedEffect> fitted_effects(const std::vector<FittedParameter>& parameters) {
  std::vector<FittedEffect> effects;
  for (const FittedParameter& parameter : parameters) {
    const std::size_t dot = parameter.name.rfind('.');
    const std::string id = parameter.name.substr(0, dot);
    if (effects.empty() || effects.back().id != id) effects.push_back({id});
    effects.back().parameters.push_back(parameter);
    effects.back().parameters.back().name = parameter.name.substr(dot + 1);
  }
  return effects;
}

}  // namespace pcor
