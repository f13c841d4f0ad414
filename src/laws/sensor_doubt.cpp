#include "laws/sensor_doubt.hpp"

#include <algorithm>
#include <cmath>

#include <pcor/effects/catalogue.hpp>

#include "laws/calibration.hpp"

namespace pcor::internal {
namespace {

bool has_effect(const ModelFile& model, std::string_view id) {
  const std::vector<ModelEffect>& effects = model.model.effects;
  return std::any_of(effects.begin(), effects.end(),
                     [id](const ModelEffect& effect) { return effect.id == id; });
}

}  // namespace

std::string SensorDoubt::name() const {
  return effect + "." + std::string(effect_facts[effect_named(effect)].parameters[parameter].name);
}

bool has_doubt(std::string_view coefficient) {
  for (const EffectFacts& facts : effect_facts) {
    for (std::size_t p = 0; p < parameter_capacity; ++p) {
      if (facts.parameters[p].doubt > 0.0 && SensorDoubt{std::string(facts.id), p}.name() == coefficient)
        return true;
    }
  }
  return false;
}

std::vector<SensorDoubt> doubts_of(const ModelFile& model, const std::vector<std::string_view>& effects) {
  std::vector<SensorDoubt> doubts;
  for (const std::string_view id : effects) {
    if (has_effect(model, id) || (id == "temp-offset" && has_effect(model, calibration_id))) continue;
    const EffectFacts& facts = effect_facts[effect_named(id)];
    for (std::size_t p = 0; p < parameter_capacity; ++p) {
      if (!(facts.parameters[p].doubt > 0.0)) continue;
      SensorDoubt doubt{std::string(id), p, facts.parameters[p].doubt};
      const auto stated = model.uncertainty.sensors.find(doubt.name());
      doubt.is_usual = stated == model.uncertainty.sensors.end();
      if (!doubt.is_usual) doubt.size = stated->second;
      if (doubt.size > 0.0) doubts.push_back(std::move(doubt));
    }
  }
  return doubts;
}

ModelFile with_doubts(ModelFile model, const std::vector<SensorDoubt>& doubts) {
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
