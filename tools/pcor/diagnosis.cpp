#include "diagnosis.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <pcor/base/error.hpp>
#include <pcor/base/suggest.hpp>
#include <pcor/base/utc.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/model/formula.hpp>
#include "comparison.hpp"
#include "shaped_effect.hpp"

namespace pcor::tool {
namespace {

using Json = nlohmann::ordered_json;

/// List of the results of `as_one` for each element.
template <class Items, class Function>
Json list_of(const Items& items, const Function& as_one) {
  Json list = Json::array();
  for (const auto& item : items) list.push_back(as_one(item));
  return list;
}

Json estimates_as_json(const std::vector<Estimate>& estimates) {
  return list_of(estimates, [](const Estimate& estimate) {
    return Json{{"name", estimate.name},
                {"unit", estimate.unit},
                {"value", estimate.value},
                {"stderr", estimate.standard_error},
                {"typical", estimate.typical}};
  });
}

Json alias_as_json(const Alias& alias) {
  return {{"effect", alias.effect},
          {"title", alias.title},
          {"correlation", alias.correlation},
          {"chi2_less", alias.chi2_less},
          {"size_to_usual", alias.size_to_usual},
          {"estimates", estimates_as_json(alias.estimates)}};
}

Json evidence_as_json(const Evidence& evidence) {
  return {{"flight", evidence.flight},
          {"begin", utc_text(evidence.begin, iso_time)},
          {"end", utc_text(evidence.end, iso_time)},
          {"regimes", evidence.regimes},
          {"share", evidence.share}};
}

Json finding_as_json(const Finding& finding) {
  Json json = as_json(finding.effect);
  json["title"] = finding.title;
  json["stderr"] = Json::object();
  json["units"] = Json::object();
  for (const Estimate& estimate : finding.estimates) {
    json["stderr"][estimate.name] = estimate.standard_error;
    json["units"][estimate.name] = estimate.unit;
  }
  json["estimates"] = estimates_as_json(finding.estimates);
  json["rms_hpa"] = finding.rms;
  json["worst_hpa"] = finding.worst;
  json["worst_flight"] = finding.worst_flight;
  json["worst_time"] = utc_text(finding.worst_time, iso_time);
  json["chi2"] = finding.chi2;
  json["p_value"] = finding.p_value;
  json["rms_before_hpa"] = finding.rms_before;
  json["rms_after_hpa"] = finding.rms_after;
  json["events"] = finding.events;
  json["evidence"] = list_of(finding.evidence, evidence_as_json);
  json["aliases"] = list_of(finding.aliases, [](const Alias& alias) { return Json(alias.effect); });
  json["alias_details"] = list_of(finding.aliases, alias_as_json);
  json["effect"] = finding.id();
  json["family"] = finding.family;
  json["shape"] = finding.shape;
  json["variants"] = finding.variants;
  json["places"] = finding.places;
  json["times_usual"] = finding.times_usual;
  json["probability"] = finding.probability;
  json["advice"] = finding.advice.sentence;
  json["advice_details"] = {{"manoeuvre", finding.advice.manoeuvre},
                            {"duration_s", finding.advice.duration},
                            {"power", finding.advice.power}};
  return json;
}

Json limit_as_json(const UpperLimit& limit) {
  return {{"effect", limit.effect}, {"title", limit.title}, {"estimates", estimates_as_json(limit.estimates)},
          {"limits", limit.limits}, {"rms_hpa", limit.rms}, {"note", limit.note}};
}

Json variable_as_json(const EmpiricalPredictor& variable) {
  return {{"name", variable.name},
          {"unit", variable.unit},
          {"description", variable.description},
          {"r2", variable.r2},
          {"p_value", variable.p_value},
          {"linear_r2", variable.linear_r2},
          {"slope", variable.slope},
          {"slope_stderr", variable.slope_error},
          {"centre", variable.centre},
          {"formula", variable.formula},
          {"places", variable.places},
          {"sampling", variable.sampling}};
}

Json step_as_json(const FlightOffset& step) {
  return {{"flight", step.flight},
          {"size_hpa", step.size},
          {"stderr_hpa", step.standard_error},
          {"p_value", step.p_value}};
}

std::string option(const char* name, const std::string& value) { return " " + shell_option(name, value); }

/// Name of a model's file, reduced to characters without a meaning in a shell.
std::string plain_stem(const std::string& model) {
  std::string stem = std::filesystem::path(model).stem().string();
  for (char& letter : stem) {
    const bool is_plain =
        std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '.' || letter == '_';
    if (!is_plain) letter = '-';
  }
  return stem.empty() || stem.front() == '-' ? "model" + stem : stem;
}

}  // namespace

void add_candidate_options(CLI::App& command, CandidateOptions& options) {
  add_list_option(command, "--try", options.formulas,
                  "test a user-defined effect too: its formula, hPa at the static ports, with a coefficient "
                  "k and variables by netCDF name or by role: 'k * ENGTRQ / 100'; they are called try-1, "
                  "try-2 ... in alphabetical order")
      ->type_name("FORMULA");
  command
      .add_option("--candidates", options.file,
                  "a model whose formula effects are also tested, unless MODEL has them")
      ->type_name("MODEL2.toml");
}

ModelEffect formula_effect(const std::string& id, const std::string& formula, const std::string& option) {
  ModelEffect effect;
  effect.id = id;
  effect.parameter_names = {"k"};
  effect.parameters = {0.0};
  effect.formula = formula;
  effect.unit = info_of(effect.location).unit;
  FormulaError error;
  const auto parsed = Formula::parse(formula, effect.parameter_names, &error);
  if (!parsed) throw Error(fmt::format("{} '{}': {}; correct it", option, formula, error.message));
  if (!parsed->unused_parameters().empty()) {
    throw Error(fmt::format("{} '{}': the formula has no coefficient k to fit; write e.g. 'k * ENGTRQ / 100'",
                            option, formula));
  }
  return effect;
}

void require_known_variables(const ModelEffect& effect, const std::string& option,
                             const std::vector<std::string>& variables, const std::string& place) {
  const auto formula = Formula::parse(effect.formula, effect.parameter_names);
  for (const std::string& name : formula->variables()) {
    if (quantity_named(name) != Quantity::count) continue;
    if (std::find(variables.begin(), variables.end(), name) != variables.end()) continue;
    const std::string meant = did_you_mean(name, variables);
    throw Error(fmt::format("{} '{}': {} is neither a variable of {} nor a quantity; {}", option,
                            effect.formula, name, place, meant.empty() ? "correct the formula" : meant));
  }
}

std::vector<ModelEffect> candidate_formulas(const CandidateOptions& options, const ModelDefinition& model,
                                            const FlightSet& flights) {
  std::vector<ModelEffect> candidates;
  const auto is_new = [&](const std::string& id) {
    const auto same = [&id](const ModelEffect& effect) { return effect.id == id; };
    return std::none_of(model.model.effects.begin(), model.model.effects.end(), same) &&
           std::none_of(candidates.begin(), candidates.end(), same);
  };
  if (!options.file.empty()) {
    for (const ModelEffect& effect : read_model(options.file).model.effects) {
      if (effect.is_formula() && is_new(effect.id)) candidates.push_back(effect);
    }
  }
  if (options.formulas.empty()) return candidates;
  std::vector<std::string> variables;
  for (const std::vector<std::string>& of_one : flights.variables())
    variables.insert(variables.end(), of_one.begin(), of_one.end());
  std::sort(variables.begin(), variables.end());
  variables.erase(std::unique(variables.begin(), variables.end()), variables.end());
  const std::string place = flights.size() == 1 ? flights.path(0).string() : "any of the flights";
  std::vector<std::string> formulas = options.formulas;
  std::sort(formulas.begin(), formulas.end());
  std::size_t number = 0;
  for (const std::string& formula : formulas) {
    do ++number;
    while (!is_new(fmt::format("try-{}", number)));
    candidates.push_back(formula_effect(fmt::format("try-{}", number), formula, "--try"));
    require_known_variables(candidates.back(), "--try", variables, place);
  }
  return candidates;
}

std::string command_line(const CandidateOptions& options) {
  std::string line;
  for (const std::string& formula : options.formulas) line += option("--try", formula);
  if (!options.file.empty()) line += option("--candidates", options.file);
  return line;
}

void add_commands(WhatIf& what_if, const std::string& model, const std::string& first_flight,
                  const std::string& fit) {
  for (std::size_t e = 0; e < what_if.effects.size(); ++e) {
    const ModelEffect& effect = what_if.effects[e];
    WhatIfEffect& shown = what_if.panel.effects[e];
    const bool of_reference = shown.id != effect.id;
    if (!effect.is_formula() && !of_reference) shown.argument = shell_quote(argument_of(effect));
    if (effect.is_formula() && effect.parameter_names == std::vector<std::string>{"k"})
      shown.argument = fmt::format("{} {} --where {}", shell_quote(effect.id),
                                   shell_option("--formula", effect.formula), info_of(effect.location).name);
  }
  for (const WhatIfEffect& shown : what_if.panel.effects) {
    for (std::size_t c = shown.first; c < shown.first + shown.count; ++c) {
      WhatIfCoefficient& coefficient = what_if.panel.coefficients[c];
      coefficient.argument = shell_quote(shown.id + "." + coefficient.name);
    }
  }
  what_if.panel.commands = {fmt::format("{} add", program()), shell_path(model),
                            fmt::format("--flight {}", shell_path(first_flight)),
                            fmt::format("{} refit {}", program(), fit), plain_stem(model)};
}

std::string probability(double p) { return p < 0.001 ? "< 0.001" : fmt::format("{:.3f}", p); }

void print_unexplained(const Unexplained& unexplained) {
  if (!unexplained.significant) return;
  say("\nunexplained residual: {:.3f} hPa rms (p {}), including {:.3f} hPa of slow drift{}{}\n",
      unexplained.rms, probability(unexplained.p_value), unexplained.drift_rms,
      unexplained.regime.empty() ? "" : "; most of it in ", unexplained.regime);
  if (!unexplained.variables.empty()) {
    say("{:<20} {:<10} {:>6} {:>8} {:>20}  {:<32} {}\n", "correlates with", "unit", "R2", "p", "hPa per unit",
        "formula", "description");
  }
  for (const EmpiricalPredictor& variable : unexplained.variables) {
    say("{:<20} {:<10} {:>6.3f} {:>8} {:>20}  {:<32} {}\n", variable.name, variable.unit, variable.r2,
        probability(variable.p_value), fmt::format("{:.3g} +- {:.2g}", variable.slope, variable.slope_error),
        variable.formula, variable.description);
  }
  if (!unexplained.variables.empty()) {
    const EmpiricalPredictor& first = unexplained.variables.front();
    say("{}\n", places_text(first));
  }
  for (const FlightOffset& step : unexplained.steps) {
    say("{} lies {:.3f} +- {:.3f} hPa {} the rest of the flights (p {})\n", step.flight, std::abs(step.size),
        step.standard_error, step.size < 0.0 ? "below" : "above", probability(step.p_value));
  }
  const std::size_t untested = unexplained.computed.size() + unexplained.shares_noise.size();
  if (untested > 0) {
    say("{} variables were not tested, because they derive from the inputs of the residual; --json and "
        "--report name them\n",
        untested);
  }
}

Json as_json(const ModelEffect& effect) {
  Json json{{"effect", effect.id}, {"parameters", Json::object()}};
  const std::vector<std::string> names = parameter_names(effect);
  for (std::size_t i = 0; i < names.size(); ++i) json["parameters"][names[i]] = effect.parameters[i];
  if (!effect.scaling.is_none()) {
    json["scaling"] = {{"static_pressure", effect.scaling.static_pressure},
                       {"dynamic_pressure", effect.scaling.dynamic_pressure}};
  }
  if (effect.is_formula()) {
    json["where"] = info_of(effect.location).name;
    json["formula"] = effect.formula;
    json["unit"] = effect.unit;
    json["source"] = effect.source;
  }
  return json;
}

Json as_json(const Unexplained& unexplained) {
  return {{"significant", unexplained.significant},
          {"rms_hpa", unexplained.rms},
          {"drift_rms_hpa", unexplained.drift_rms},
          {"p_value", unexplained.p_value},
          {"regime", unexplained.regime},
          {"variables", list_of(unexplained.variables, variable_as_json)},
          {"steps", list_of(unexplained.steps, step_as_json)},
          {"shares_noise", unexplained.shares_noise},
          {"computed", unexplained.computed}};
}

Json as_json(const Diagnosis& diagnosis) {
  Json json{{"verdict", to_string(diagnosis.verdict)}, {"reference", diagnosis.reference}};
  json["findings"] = list_of(diagnosis.findings, finding_as_json);
  json["unexplained"] = as_json(diagnosis.unexplained);
  json["absorbed"] = list_of(diagnosis.absorbed, [](const AbsorbedEffect& effect) {
    return Json{{"effect", effect.effect},
                {"title", effect.title},
                {"by", effect.by},
                {"remaining", effect.remaining}};
  });
  json["limits"] = list_of(diagnosis.limits, limit_as_json);
  json["not_testable"] = list_of(diagnosis.not_testable, [](const NotTestable& effect) {
    return Json{{"effect", effect.effect}, {"title", effect.title}, {"reason", effect.reason}};
  });
  json["candidates"] = diagnosis.candidates;
  json["threshold"] = diagnosis.threshold;
  json["rms_given_hpa"] = diagnosis.rms_given;
  json["residual_rms_hpa"] = diagnosis.residual_rms;
  json["residual_rms_held_out_hpa"] = diagnosis.residual_rms_held_out;
  json["noise_rms_hpa"] = diagnosis.noise_rms;
  json["noise_rms_with_findings_hpa"] = diagnosis.noise_rms_with_findings;
  json["samples"] = diagnosis.samples;
  json["flaps_out"] = as_json(diagnosis.flaps_out);
  json["held_out"] = list_of(diagnosis.held_out, [](const HeldOutPart& part) {
    Json entry{{"name", part.flight}, {"is_off", part.is_off()}, {"expected_bias_hpa", part.expected}};
    entry.update(as_json(part.statistics));
    return entry;
  });
  json["masks"] = masks_as_json(diagnosis.masks);
  json["notes"] = diagnosis.notes;
  return json;
}

}  // namespace pcor::tool
