#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <string>

#include <pcor/effects/catalogue.hpp>
#include <pcor/model/model.hpp>

namespace pcor {

namespace detail {

inline std::string text_of_number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

inline std::string fault_of(const ParameterInfo& parameter, const std::string& effect, double value) {
  const std::string unit = parameter.unit == "1" ? "" : " " + std::string(parameter.unit);
  return "the coefficient '" + std::string(parameter.name) + "' of " + effect + " is " +
         text_of_number(value) + unit + "; give " + text_of_number(parameter.lower) + " to " +
         text_of_number(parameter.upper) + unit;
}

inline std::string fault_of(const ModelEffect& effect) {
  const EffectInfo* const info =
      effect.is_formula() || effect.is_surface() ? nullptr : effect_named(effect.id);
  const std::string end = " of effect '" + effect.id + "'";
  for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
    const double value = effect.parameters[i];
    if (info != nullptr && i < info->parameter_count() && !info->parameters[i].allows(value))
      return fault_of(info->parameters[i], effect.id, value);
    if (!is_finite(value)) {
      return "coefficient number " + std::to_string(i + 1) + end + " is " + text_of_number(value) +
             "; give a finite number";
    }
  }
  for (const int power : {effect.scaling.static_pressure, effect.scaling.dynamic_pressure}) {
    if (power < -max_power || power > max_power) {
      return "a scaling exponent" + end + " is " + std::to_string(power) + "; give -" +
             std::to_string(max_power) + " to " + std::to_string(max_power);
    }
  }
  return "";
}

}  // namespace detail

/// Fault in the numbers of a model that was built in a program, and the next step; empty without a fault. The
/// reader of model files refuses the same numbers. Faults of its effects and their inputs: `ModelBinder`.
inline std::string fault_of(const Model& model) {
  using detail::text_of_number;
  for (auto effect = model.effects.begin(); effect != model.effects.end(); ++effect) {
    const bool is_twice = std::any_of(model.effects.begin(), effect,
                                      [&](const ModelEffect& other) { return other.id == effect->id; });
    if (is_twice) return "effect '" + effect->id + "' is in the model twice; remove one";
    const std::string fault = detail::fault_of(*effect);
    if (!fault.empty()) return fault;
  }
  if (!model.recovery.is_possible()) {
    return "the recovery factor is " + text_of_number(model.recovery.coefficients[0]) +
           ", or another of its coefficients is not finite; give a number above 0, at most " +
           text_of_number(RecoveryFactor::maximum);
  }
  for (const DomainRange& range : model.domain) {
    if (!(range.lower < range.upper)) {
      return "the domain of '" + range.quantity + "' is from " + text_of_number(range.lower) + " to " +
             text_of_number(range.upper) + "; give two numbers that increase";
    }
  }
  struct Number {
    const char* name;
    double value;
    double minimum;
  };
  constexpr double any = std::numeric_limits<double>::lowest();
  for (const Number& number :
       {Number{"taper_below (hPa) of the policy", model.policy.taper_below, 0.0},
        Number{"taper_power of the policy", model.policy.taper_power, 0.0},
        Number{"min_dynamic_pressure (hPa) of the policy", model.policy.min_dynamic_pressure, 0.0},
        Number{"elevation (deg) of LAMS", model.lams.elevation, any},
        Number{"azimuth (deg) of LAMS", model.lams.azimuth, any},
        Number{"offset (deg) of the attack of the radome", model.attack_radome.offset, any},
        Number{"slope (deg) of the attack of the radome", model.attack_radome.slope, any},
        Number{"slope_mach (deg) of the attack of the radome", model.attack_radome.slope_mach, any},
        Number{"offset (deg) of the sideslip of the radome", model.sideslip_radome.offset, any},
        Number{"slope (deg) of the sideslip of the radome", model.sideslip_radome.slope, any},
        Number{"slope_mach (deg) of the sideslip of the radome", model.sideslip_radome.slope_mach, any}}) {
    if (is_finite(number.value) && number.value >= number.minimum) continue;
    return std::string(number.name) + " is " + text_of_number(number.value) + "; give a finite number" +
           (number.minimum == 0.0 ? " of 0 or above" : "");
  }
  if (is_missing(model.policy.minimum)) return "minimum (hPa) of the policy is NaN; give a number";
  return "";
}

}  // namespace pcor
