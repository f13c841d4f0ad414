#include <pcor/model_io/model_definition.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include <pcor/base/atomic_file.hpp>
#include <pcor/base/error.hpp>
#include <pcor/effects/catalogue.hpp>

#include "base/text_file.hpp"
#include "model_io/model_names.hpp"
#include "model_io/output_table.hpp"
#include "model_io/sensor_uncertainty.hpp"

namespace pcor {

using namespace internal;

namespace fs = std::filesystem;

ModelDefinition::ModelDefinition() = default;
ModelDefinition::ModelDefinition(const ModelDefinition&) = default;
ModelDefinition::ModelDefinition(ModelDefinition&&) noexcept = default;
ModelDefinition& ModelDefinition::operator=(const ModelDefinition&) = default;
ModelDefinition& ModelDefinition::operator=(ModelDefinition&&) noexcept = default;
ModelDefinition::~ModelDefinition() = default;

void set_entry(Provenance& provenance, const std::string& key, ProvenanceValue value) {
  erase_entry(provenance, key);
  provenance.emplace_back(key, std::move(value));
}

void erase_entry(Provenance& provenance, std::string_view key) {
  const auto has_key = [key](const auto& entry) { return entry.first == key; };
  provenance.erase(std::remove_if(provenance.begin(), provenance.end(), has_key), provenance.end());
}

std::vector<Quantity> ModelDefinition::roles() const {
  std::vector<Quantity> roles;
  for (const auto& [role, variable] : variables) roles.push_back(role);
  return roles;
}

std::string ModelDefinition::variable_of(Quantity role) const {
  const auto found = variables.find(role);
  return found == variables.end() ? std::string() : found->second;
}

std::string ModelDefinition::output_name(std::string_view standard_name) const {
  const auto renamed = output.find(std::string(standard_name));
  if (renamed != output.end()) return renamed->second;
  const std::size_t end = standard_name.rfind(uncertainty_ending);
  if (end == 0 || end == std::string_view::npos || end + uncertainty_ending.size() != standard_name.size())
    return std::string(standard_name);
  return output_name(standard_name.substr(0, end)).append(uncertainty_ending);
}

ModelUncertainty internal::stated_uncertainty(const ModelDefinition& file) {
  const std::vector<NamedParameter> parameters = named_parameters(file.model);
  const std::size_t count = parameters.size();
  ModelUncertainty uncertainty;
  uncertainty.covariance.assign(count * count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    const double error = file.fit(parameters[i].effect, parameters[i].number).standard_error.value_or(0.0);
    uncertainty.covariance[i * count + i] = error * error;
  }
  std::vector<std::size_t> indices;  // `count` for a sensor without an effect in the model
  for (const std::string& name : file.covariance.parameters) {
    const auto found = std::find_if(parameters.begin(), parameters.end(),
                                    [&name](const NamedParameter& each) { return each.name == name; });
    if (found == parameters.end() && !has_default_uncertainty(name)) {
      throw Error(
          Error::Code::definition,
          fmt::format(
              "model '{}': its covariance names {}, which is not a parameter of the model; refit the model",
              file.model.name, quote(name)));
    }
    indices.push_back(static_cast<std::size_t>(found - parameters.begin()));
  }
  for (std::size_t i = 0; i < indices.size(); ++i) {
    for (std::size_t j = 0; j < indices.size(); ++j) {
      if (indices[i] == count || indices[j] == count) continue;
      uncertainty.covariance[indices[i] * count + indices[j]] = file.covariance.matrix[i][j];
    }
  }
  for (const auto& [role, size] : file.uncertainty.roles) uncertainty.random[index(role)] = size;
  uncertainty.static_defect = file.uncertainty.static_defect.value_or(0.0);
  uncertainty.static_defect_ratio = file.uncertainty.static_defect_ratio.value_or(0.0);
  return uncertainty;
}

ModelUncertainty uncertainty_of(const ModelDefinition& file) {
  ModelUncertainty stated = stated_uncertainty(file);
  // Without pressure variables the names follow from the flight's aircraft.
  const bool has_thermometer = file.variables.count(Quantity::static_pressure) == 0 ||
                               file.variables.count(Quantity::recovery_temperature) != 0;
  if (!has_thermometer || !(stated.has_systematic() || stated.has_random())) return stated;
  const ModelDefinition whole = with_uncertain_sensors(file, uncertainties_of(file, thermometer_calibration));
  stated = stated_uncertainty(whole);
  for (std::size_t i = file.model.effects.size(); i < whole.model.effects.size(); ++i)
    stated.calibration.push_back(whole.model.effects[i]);
  return stated;
}

ParameterFit ModelDefinition::fit(std::size_t effect, std::size_t parameter) const {
  if (effect >= fits.size() || parameter >= fits[effect].size()) return {};
  return fits[effect][parameter];
}

Bounds ModelDefinition::bounds(std::size_t effect, std::size_t parameter) const {
  const std::optional<Bounds> fit_bounds = fit(effect, parameter).bounds;
  if (fit_bounds) return *fit_bounds;
  const ModelEffect& which = model.effects[effect];
  const EffectInfo* const info = effect_named(which.id);
  if (which.is_formula() || info == nullptr) return {};
  return {info->parameters[parameter].lower, info->parameters[parameter].upper};
}

bool has_effect(const ModelDefinition& file, std::string_view id) {
  const std::vector<ModelEffect>& effects = file.model.effects;
  return std::any_of(effects.begin(), effects.end(), [id](const ModelEffect& each) { return each.id == id; });
}

std::vector<std::string> parameter_names(const ModelEffect& effect) {
  if (effect.is_formula()) return effect.parameter_names;
  const std::size_t count = neutral_effect(effect.id).parameters.size();
  Names names = names_of(effect_named(effect.id)->parameters, &ParameterInfo::name);
  names.resize(count);
  return names;
}

ModelEffect neutral_effect(std::string_view id) {
  const EffectInfo* const info = effect_named(id);
  if (info == nullptr) {
    throw Error(Error::Code::usage, fmt::format("there is no effect {} in the catalogue; {}", quote(id),
                                                suggestion_text(id, names_of(effect_info, &EffectInfo::id))));
  }
  ModelEffect effect;
  effect.id = id;
  for (std::size_t i = 0; i < info->parameter_count(); ++i) {
    effect.parameters.push_back(info->parameters[i].neutral);
  }
  return effect;
}

EffectLocation location_of(const ModelEffect& effect) {
  if (effect.is_surface()) return EffectLocation::static_defect;
  return effect.is_formula() ? effect.location : effect_named(effect.id)->location;
}

bool is_neutral(const ModelEffect& effect) {
  if (effect.is_formula() && !effect.is_surface()) return false;
  const EffectInfo* const info = effect.is_surface() ? nullptr : effect_named(effect.id);
  for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
    const bool is_shape = info != nullptr && info->parameters[i].shape;
    if (!is_shape && effect.parameters[i] != (info == nullptr ? 0.0 : info->parameters[i].neutral))
      return false;
  }
  return true;
}

ModelEffect surface_effect(const std::string& id, const std::array<SurfaceAxis, 2>& axes) {
  ModelEffect effect;
  effect.id = id;
  effect.surface = Surface{axes};
  effect.formula = fmt::format("dynamic_pressure * Cp({}, {})", info_of(axes[0].quantity).name,
                               info_of(axes[1].quantity).name);
  effect.unit = info_of(effect.location).unit;
  effect.parameters.assign(effect.surface->parameter_count(), 0.0);
  for (std::size_t i = 1; i <= axes[0].count; ++i) {
    for (std::size_t j = 1; j <= axes[1].count; ++j)
      effect.parameter_names.push_back(fmt::format("c{}_{}", i, j));
  }
  return effect;
}

ModelDefinition read_model(const fs::path& path) {
  ModelDefinition file = parse_model(text_of_file(path, "a model file"), path.string());
  // A file with the variable names of an aircraft lies in the folder of the model.
  if (const fs::path roles = file.roles_from; roles.extension() == ".toml" && roles.is_relative())
    file.roles_from = fs::absolute(path.parent_path() / roles).lexically_normal().string();
  return file;
}

void save_model(const ModelDefinition& file, const fs::path& path, const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs) {
    std::error_code code;
    if (!fs::equivalent(path, input, code)) continue;
    throw Error(
        Error::Code::usage,
        path.string() +
            ": the model was read from this file, which is never overwritten; give the output another name");
  }
  AtomicFile(path).write(write_model(file));
}

}  // namespace pcor
