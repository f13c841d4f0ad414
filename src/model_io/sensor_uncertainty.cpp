#include "model_io/sensor_uncertainty.hpp"

#include <algorithm>

#include <pcor/effects/catalogue.hpp>

#include "model_io/model_names.hpp"

namespace pcor::internal {
std::string SensorUncertainty::name() const {
  return effect + "." + std::string(effect_named(effect)->parameters[parameter].name);
}

bool has_default_uncertainty(std::string_view coefficient) {
  for (const EffectInfo& info : effect_info) {
    for (std::size_t p = 0; p < parameter_capacity; ++p) {
      if (info.parameters[p].calibration_uncertainty > 0.0 &&
          SensorUncertainty{std::string(info.id), p}.name() == coefficient)
        return true;
    }
  }
  return false;
}

bool corrects_error_of(std::string_view coefficient, std::string_view other) {
  return coefficient == other || (coefficient == "temp-calibration.a0" && other == "temp-offset.offset");
}

std::vector<SensorUncertainty> uncertainties_of(const ModelDefinition& model,
                                                const std::vector<std::string_view>& effects) {
  const std::vector<NamedParameter> coefficients = named_parameters(model.model);
  std::vector<SensorUncertainty> uncertainties;
  for (const std::string_view id : effects) {
    const EffectInfo& info = *effect_named(id);
    for (std::size_t p = 0; p < parameter_capacity; ++p) {
      if (!(info.parameters[p].calibration_uncertainty > 0.0)) continue;
      SensorUncertainty uncertainty{std::string(id), p, info.parameters[p].calibration_uncertainty};
      if (std::any_of(coefficients.begin(), coefficients.end(), [&](const NamedParameter& each) {
            return corrects_error_of(each.name, uncertainty.name());
          }))
        continue;
      const auto stated = model.uncertainty.sensors.find(uncertainty.name());
      uncertainty.is_usual = stated == model.uncertainty.sensors.end();
      if (!uncertainty.is_usual) uncertainty.size = stated->second;
      if (uncertainty.size > 0.0) uncertainties.push_back(std::move(uncertainty));
    }
  }
  return uncertainties;
}

ModelDefinition with_uncertain_sensors(ModelDefinition model,
                                       const std::vector<SensorUncertainty>& uncertainties) {
  std::vector<ModelEffect>& effects = model.model.effects;
  for (const SensorUncertainty& uncertainty : uncertainties) {
    if (!has_effect(model, uncertainty.effect)) {
      model.fits.resize(effects.size());
      effects.push_back(neutral_effect(uncertainty.effect));
      model.fits.emplace_back(effects.back().parameters.size());
      for (ParameterFit& fit : model.fits.back()) fit.fixed = true;
    }
    if (effects.back().id == uncertainty.effect)
      model.fits.back()[uncertainty.parameter].standard_error = uncertainty.size;
  }
  return model;
}

}  // namespace pcor::internal
