#include "model_io/sensor_doubt.hpp"

#include <algorithm>

#include <pcor/effects/catalogue.hpp>

#include "model_io/model_names.hpp"

namespace pcor::internal {
std::string SensorDoubt::name() const {
  return effect + "." + std::string(effect_named(effect)->parameters[parameter].name);
}

bool has_doubt(std::string_view coefficient) {
  for (const EffectInfo& info : effect_info) {
    for (std::size_t p = 0; p < parameter_capacity; ++p) {
      if (info.parameters[p].calibration_uncertainty > 0.0 &&
          SensorDoubt{std::string(info.id), p}.name() == coefficient)
        return true;
    }
  }
  return false;
}

bool corrects_error_of(std::string_view coefficient, std::string_view other) {
  return coefficient == other || (coefficient == "temp-calibration.a0" && other == "temp-offset.offset");
}

std::vector<SensorDoubt> doubts_of(const ModelDefinition& model,
                                   const std::vector<std::string_view>& effects) {
  const std::vector<NamedParameter> coefficients = named_parameters(model.model);
  std::vector<SensorDoubt> doubts;
  for (const std::string_view id : effects) {
    const EffectInfo& info = *effect_named(id);
    for (std::size_t p = 0; p < parameter_capacity; ++p) {
      if (!(info.parameters[p].calibration_uncertainty > 0.0)) continue;
      SensorDoubt doubt{std::string(id), p, info.parameters[p].calibration_uncertainty};
      if (std::any_of(coefficients.begin(), coefficients.end(),
                      [&](const NamedParameter& each) { return corrects_error_of(each.name, doubt.name()); }))
        continue;
      const auto stated = model.uncertainty.sensors.find(doubt.name());
      doubt.is_usual = stated == model.uncertainty.sensors.end();
      if (!doubt.is_usual) doubt.size = stated->second;
      if (doubt.size > 0.0) doubts.push_back(std::move(doubt));
    }
  }
  return doubts;
}

ModelDefinition with_doubts(ModelDefinition model, const std::vector<SensorDoubt>& doubts) {
  std::vector<ModelEffect>& effects = model.model.effects;
  for (const SensorDoubt& doubt : doubts) {
    if (!has_effect(model, doubt.effect)) {
      model.fits.resize(effects.size());
      effects.push_back(neutral_effect(doubt.effect));
      model.fits.emplace_back(effects.back().parameters.size());
      for (ParameterFit& fit : model.fits.back()) fit.fixed = true;
    }
    if (effects.back().id == doubt.effect) model.fits.back()[doubt.parameter].standard_error = doubt.size;
  }
  return model;
}

}  // namespace pcor::internal
