#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/realtime/chain.hpp>
#include <pcor/roles/add_effects.hpp>
#include "model_io/model_names.hpp"
#include "roles/role_evidence.hpp"
#include "roles/usual_variables.hpp"

namespace pcor {

using namespace internal;

namespace {

/// The first of the usual names among `variables`, be it with the suffix of an instrument as in PLWCD_LWOI;
/// empty if no variable has such a name.
std::string usual_variable(const std::vector<std::string>& usual, const std::vector<std::string>& variables) {
  if (variables.empty() && !usual.empty()) return usual.front();
  for (const char* const suffix : {"", "_"}) {
    for (const std::string& name : usual) {
      const std::string requested = name + suffix;
      for (const std::string& variable : variables) {
        if (*suffix == '\0' ? variable == requested : variable.rfind(requested, 0) == 0) return variable;
      }
    }
  }
  return "";
}

constexpr const char* added_key = "added";

/// Parameters that only shape an effect are fixed by default.
EffectFit fit_of(const ModelEffect& effect) {
  EffectFit fit(effect.parameters.size());
  if (effect.is_formula()) return fit;
  const EffectInfo& info = *effect_named(effect.id);
  for (std::size_t i = 0; i < fit.size(); ++i) fit[i].fixed = info.parameters[i].shape;
  return fit;
}

void add(ModelDefinition& file, ModelEffect effect) {
  std::vector<ModelEffect>& effects = file.model.effects;
  if (has_effect(file, effect.id)) {
    throw Error(Error::Code::usage,
                fmt::format("model '{}' has the effect {} already; refit it, or add another",
                            one_line(file.model.name), quote(effect.id)));
  }
  if (effect.is_formula()) {
    if (effect_named(effect.id) != nullptr) {
      throw Error(Error::Code::usage,
                  fmt::format("effect {} has its formula in the catalogue; give the new formula another id",
                              quote(effect.id)));
    }
  } else {
    const ModelEffect neutral = neutral_effect(effect.id);
    if (effect.parameters.empty()) effect.parameters = neutral.parameters;
    if (effect.parameters.size() != neutral.parameters.size()) {
      throw Error(Error::Code::usage,
                  fmt::format("effect {} takes {} parameter(s), not {}; give one value for each",
                              quote(effect.id), neutral.parameters.size(), effect.parameters.size()));
    }
  }
  file.fits.resize(effects.size());
  file.fits.push_back(fit_of(effect));
  effects.push_back(std::move(effect));
}

}  // namespace

ModelDefinition add_effects(const ModelDefinition& model, const std::vector<ModelEffect>& effects,
                            const std::vector<std::string>& variables, const Flight* flight) {
  ModelDefinition file = model;
  file.law.operational = false;
  for (const ModelEffect& effect : effects) add(file, effect);
  BindingError error;
  while (!Chain::build(file.model, file.roles(), &error)) {
    const std::string why =
        fmt::format("model '{}': {}", one_line(model.model.name), one_line(error.message()));
    if (error.code != BindingError::Code::role_missing) throw Error(Error::Code::model, why);
    const std::vector<std::string> usual = usual_variables(error.quantity);
    std::string variable = usual_variable(usual, variables);
    if (variable.empty() && flight != nullptr)
      variable = sure_variable(*flight, info_of(error.quantity).name);
    if (variable.empty()) {
      throw Error(Error::Code::model,
                  why + (usual.empty()
                             ? fmt::format(" as {} = \"...\"", info_of(error.quantity).name)
                             : fmt::format("; the flight records no variable with one of its usual names {}",
                                           fmt::join(usual, ", "))));
    }
    file.variables[error.quantity] = std::move(variable);
  }
  ProvenanceList added;
  for (const std::string& earlier : added_effects(model)) added.emplace_back(earlier);
  for (const ModelEffect& effect : effects) added.emplace_back(effect.id);
  set_entry(file.provenance, added_key, std::move(added));
  return file;
}

std::vector<std::string> added_effects(const ModelDefinition& model) {
  std::vector<std::string> ids;
  const auto* const list = find_entry<ProvenanceList>(model.provenance, added_key);
  if (list == nullptr) return ids;
  for (const ProvenanceValue& each : *list) {
    if (const auto* const id = std::get_if<std::string>(&each)) ids.push_back(*id);
  }
  return ids;
}

}  // namespace pcor
