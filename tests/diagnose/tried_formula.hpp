#pragma once

#include <pcor/model/effect.hpp>

#include <string>

namespace pcor::test {

/// A formula at the static ports with a coefficient k.
inline ModelEffect tried_formula(const std::string& text) {
  ModelEffect effect;
  effect.id = "try-1";
  effect.formula = text;
  effect.parameter_names = {"k"};
  effect.parameters = {0.0};
  return effect;
}

}  // namespace pcor::test
