#include "model_io/parameter_unit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <pcor/effects/catalogue.hpp>
#include <pcor/model/formula.hpp>

namespace pcor::internal {
namespace {

std::string unit_in_formula(const ModelEffect& effect, std::size_t number) {
  const auto formula = Formula::parse(effect.formula, effect.parameter_names);
  if (!formula) return "";
  const std::vector<std::string>& names = formula->variables();
  std::vector<double> variables(names.size(), 0.3);
  std::vector<double> coefficients(effect.parameter_names.size(), 1.0);
  const auto value = [&](double coefficient) {
    coefficients[number] = coefficient;
    return formula->value(variables.data(), coefficients.data());
  };
  const double slope = value(1.0) - value(0.0);
  const double curvature = value(2.0) - value(1.0) - slope;
  std::fill(coefficients.begin(), coefficients.end(), 2.0);
  const double change = value(1.0) - value(0.0) - slope;  // caused by the other coefficients
  const double rounding = 1e-9 * std::abs(slope);
  if (!(slope != 0.0 && std::abs(curvature) + std::abs(change) <= rounding)) return "";
  std::string unit(info_of(effect.location).unit);
  bool is_divided = false;
  for (std::size_t v = 0; v < names.size(); ++v) {
    const Quantity quantity = quantity_named(names[v]);
    if (quantity != Quantity::count && info_of(quantity).unit == "1") continue;
    constexpr double usual = 0.3;
    constexpr std::array<double, 2> factors{2.0, 3000.0};  // small and large values: limits are seen
    std::size_t constant = 0;
    std::size_t proportional = 0;
    for (const double factor : factors) {
      variables[v] = factor * usual;
      const double ratio = (value(1.0) - value(0.0)) / slope;
      if (std::abs(ratio - 1.0) < 1e-9) ++constant;
      if (std::abs(ratio - factor) < 1e-9 * factor) ++proportional;
    }
    variables[v] = usual;
    if (constant == factors.size()) continue;
    if (quantity == Quantity::count || is_divided || proportional != factors.size()) return "";
    const std::string divisor(info_of(quantity).unit);
    unit += divisor.find('/') == std::string::npos ? "/" + divisor : "/(" + divisor + ")";
    is_divided = true;
  }
  return unit;
}

}  // namespace

std::string parameter_unit(const ModelEffect& effect, std::size_t number) {
  if (effect.is_surface()) return "1";
  if (effect.is_formula()) return unit_in_formula(effect, number);
  return std::string(effect_named(effect.id)->parameters[number].unit);
}

}  // namespace pcor::internal
