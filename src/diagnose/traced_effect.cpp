#include "diagnose/traced_effect.hpp"

#include <fmt/format.h>

#include <cctype>

namespace pcor::internal {

std::string id_of_trace(const std::string& variable) {
  std::string id = "traced-";
  for (const unsigned char letter : variable)
    id += std::isalnum(letter) != 0 ? static_cast<char>(std::tolower(letter)) : '-';
  return id;
}

ModelEffect effect_of(const EmpiricalPredictor& variable, const std::string& flights) {
  ModelEffect effect;
  effect.id = id_of_trace(variable.name);
  effect.parameter_names = {"k"};
  effect.parameters = {variable.slope};
  effect.formula = variable.formula;
  effect.location = variable.location;
  effect.unit = "hPa";
  effect.source = fmt::format("traced in the residuals of {}: {:.0f} % of their variance, p = {:.2g}",
                              flights, 100.0 * variable.r2, variable.p_value);
  return effect;
}

}  // namespace pcor::internal
