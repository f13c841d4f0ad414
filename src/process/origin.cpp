#include "process/origin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "process/sha256.hpp"

namespace pcor::internal {
namespace {

const char* to_string(UncertaintyPart part) {
  switch (part) {
    case UncertaintyPart::total:
      return "total";
    case UncertaintyPart::systematic:
      return "systematic";
    case UncertaintyPart::random:
      return "random";
    case UncertaintyPart::none:
      return "none";
    case UncertaintyPart::total_if_stated:
      break;
  }
  return "total if stated";
}

const char* yes_or_no(bool yes) { return yes ? "yes" : "no"; }

}  // namespace

std::string options_text(const ProcessOptions& options) {
  return fmt::format("pcor " PCOR_VERSION
                     "; corrected with: {}; time stamp: {}; uncertainty: {}; suffix: '{}'; all variables: "
                     "{}; hydrostatic: {}{}",
                     options.correct_with == CorrectWith::lams ? "LAMS" : "model",
                     options.timestamp_alignment == TimestampAlignment::begin ? "begin" : "middle",
                     to_string(options.uncertainty), options.suffix, yes_or_no(options.copy_all),
                     yes_or_no(options.hydrostatic), options.keep_frozen ? "; frozen sensors: kept" : "");
}

std::string coefficients_text(const ModelDefinition& model) {
  std::string text;
  for (std::size_t e = 0; e < model.model.effects.size(); ++e) {
    const ModelEffect& effect = model.model.effects[e];
    const std::vector<std::string> names = parameter_names(effect);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::optional<double> error = model.fit(e, i).standard_error;
      text += fmt::format("{}{}.{} = {}{}", text.empty() ? "" : "; ", effect.id, names[i],
                          effect.parameters[i], error ? fmt::format(" +- {:.3g}", *error) : "");
    }
  }
  return text;
}

bool is_neutral(const ModelEffect& effect) {
  return !effect.is_formula() && effect.parameters == neutral_effect(effect.id).parameters;
}

bool changes_no_pressure(const ModelDefinition& model, const ProcessOptions& options) {
  const std::vector<ModelEffect>& effects = model.model.effects;
  return options.correct_with == CorrectWith::model &&
         std::all_of(effects.begin(), effects.end(), is_neutral);
}

std::vector<std::pair<std::string, std::string>> origin_attributes(const std::filesystem::path& input,
                                                                   const ModelDefinition& model,
                                                                   const ProcessOptions& options) {
  const std::string text = write_model(model);
  const std::string chosen = options_text(options);
  return {{"pcor_model", model.model.name},
          {"pcor_model_source", model.law.source},
          {"pcor_model_aircraft", model.model.aircraft},
          {"pcor_model_coefficients", coefficients_text(model)},
          {"pcor_correction", changes_no_pressure(model, options) ? "none: the model changes no pressure"
                              : options.correct_with == CorrectWith::lams ? "LAMS"
                                                                          : "model"},
          {"pcor_model_toml", text},
          {model_hash_attribute, sha256_of_text(text)},
          {"pcor_options", chosen},
          {options_hash_attribute, sha256_of_text(chosen)},
          {"pcor_input", input.filename().string()},
          {input_hash_attribute, sha256_of_file(input)}};
}

}  // namespace pcor::internal
