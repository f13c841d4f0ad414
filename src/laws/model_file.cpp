#include <pcor/laws/model_file.hpp>

#include <fmt/format.h>

#include <fstream>
#include <system_error>

#include <pcor/effects/catalogue.hpp>
#include <pcor/words/error.hpp>
#include <pcor/words/replacement_file.hpp>

#include "laws/model_names.hpp"
#include "laws/model_writer.hpp"
#include "words/text_file.hpp"

namespace pcor {

using namespace internal;

namespace fs = std::filesystem;

std::vector<Quantity> ModelFile::roles() const {
  std::vector<Quantity> roles;
  for (const auto& [role, variable] : variables) roles.push_back(role);
  return roles;
}

std::string ModelFile::output_name(std::string_view standard_name) const {
  const auto renamed = output.find(std::string(standard_name));
  return renamed == output.end() ? std::string(standard_name) : renamed->second;
}

ParameterFit ModelFile::fit(std::size_t effect, std::size_t parameter) const {
  if (effect >= fits.size() || parameter >= fits[effect].size()) return {};
  return fits[effect][parameter];
}

Bounds ModelFile::bounds(std::size_t effect, std::size_t parameter) const {
  const std::optional<Bounds> own = fit(effect, parameter).bounds;
  if (own) return *own;
  const ModelEffect& which = model.effects[effect];
  const std::size_t place = effect_named(which.id);
  if (which.is_formula() || place == catalogue_size) return {};
  const ParameterFacts& facts = effect_facts[place].parameters[parameter];
  return {facts.lower, facts.upper};
}

std::vector<std::string> parameter_names(const ModelEffect& effect) {
  if (effect.is_formula()) return effect.parameter_names;
  neutral_effect(effect.id);
  return names_of_parameters(effect_facts[effect_named(effect.id)]);
}

ModelEffect neutral_effect(std::string_view id) {
  const std::size_t place = effect_named(id);
  if (place == catalogue_size) {
    throw Error(fmt::format("there is no effect {} in the catalogue; {}", in_quotes(id),
                            instead_of(id, names_of(effect_facts, &EffectFacts::id))));
  }
  ModelEffect effect;
  effect.id = id;
  const EffectFacts& facts = effect_facts[place];
  for (std::size_t i = 0; i < facts.parameter_count(); ++i) {
    effect.parameters.push_back(facts.parameters[i].neutral);
  }
  return effect;
}

ModelFile read_model(const fs::path& path) {
  return parse_model(text_of_file(path, "a model file"), path.string());
}

std::string write_model(const ModelFile& file) {
  std::string text = model_text(file);
  try {
    parse_model(text, "its text");
  } catch (const Error& error) {
    throw Error(std::string("the model cannot be written: ") + error.what());
  }
  return text;
}

void save_model(const ModelFile& file, const fs::path& path, const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs) {
    std::error_code code;
    if (!fs::equivalent(path, input, code)) continue;
    throw Error(path.string() +
                ": the model was read from this file, which is never written over; give the output another "
                "name");
  }
  const std::string text = write_model(file);
  ReplacementFile output(path);
  std::ofstream stream(output.path(), std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw Error(path.string() + ": cannot be written; check the space and the permissions");
  output.commit();
}

}  // namespace pcor
