#include "diagnosis.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <pcor/base/error.hpp>
#include <pcor/base/suggest.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/model/formula.hpp>
#include "comparison.hpp"
#include "model_name.hpp"
#include "shaped_effect.hpp"

namespace pcor::tool {
namespace {

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
  if (!parsed)
    throw Error(Error::Code::definition,
                fmt::format("{} '{}': {}; correct it", option, formula, error.message));
  if (!parsed->unused_parameters().empty()) {
    throw Error(Error::Code::definition,
                fmt::format("{} '{}': the formula has no coefficient k to fit; write e.g. 'k * ENGTRQ / 100'",
                            option, formula));
  }
  return effect;
}

void require_known_variables(const ModelEffect& effect, const std::string& option,
                             const std::vector<std::string>& variables, const std::string& where) {
  const auto formula = Formula::parse(effect.formula, effect.parameter_names);
  for (const std::string& name : formula->variables()) {
    if (quantity_named(name) != Quantity::count) continue;
    if (std::find(variables.begin(), variables.end(), name) != variables.end()) continue;
    const std::string meant = did_you_mean(name, variables);
    throw Error(Error::Code::variable,
                fmt::format("{} '{}': {} is neither a variable of {} nor a quantity; {}", option,
                            effect.formula, name, where, meant.empty() ? "correct the formula" : meant));
  }
}

std::vector<ModelEffect> candidate_formulas(const CandidateOptions& options, const ModelDefinition& model,
                                            const FlightSet& flights) {
  std::vector<ModelEffect> candidates;
  const auto is_new = [&](const std::string& id) {
    const auto same = [&id](const ModelEffect& effect) { return effect.id == id; };
    return !has_effect(model, id) && std::none_of(candidates.begin(), candidates.end(), same);
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
  const std::string where = flights.size() == 1 ? flights.path(0).string() : "any of the flights";
  std::vector<std::string> formulas = options.formulas;
  std::sort(formulas.begin(), formulas.end());
  std::size_t number = 0;
  for (const std::string& formula : formulas) {
    do ++number;
    while (!is_new(fmt::format("try-{}", number)));
    candidates.push_back(formula_effect(fmt::format("try-{}", number), formula, "--try"));
    require_known_variables(candidates.back(), "--try", variables, where);
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
  what_if.panel.commands = {fmt::format("{} add", program()), model_argument(model),
                            fmt::format("--flight {}", shell_path(first_flight)),
                            fmt::format("{} refit {}", program(), fit), plain_stem(model)};
}

std::string probability(double p) { return p < 0.001 ? "< 0.001" : fmt::format("{:.3f}", p); }

std::string slope_of(const EmpiricalPredictor& variable) {
  return variable.slope_error > 0.0 ? fmt::format("{:.3g} +- {:.2g}", variable.slope, variable.slope_error)
                                    : "no linear trend";
}

void print_unexplained(const Unexplained& unexplained) {
  if (!unexplained.significant) return;
  say("\nunexplained residual: {:.3f} hPa rms (p {}), including {:.3f} hPa of slow drift{}{}\n",
      unexplained.rms, probability(unexplained.p_value), unexplained.drift_rms,
      unexplained.regime.empty() ? "" : "; largest in ", unexplained.regime);
  if (!unexplained.variables.empty()) {
    say("{:<20} {:<10} {:>6} {:>8} {:>20}  {:<32} {}\n", "correlates with", "unit", "R2", "p", "hPa per unit",
        "formula", "description");
  }
  for (const EmpiricalPredictor& variable : unexplained.variables) {
    say("{:<20} {:<10} {:>6.3f} {:>8} {:>20}  {:<32} {}\n", variable.name, variable.unit, variable.r2,
        probability(variable.p_value), slope_of(variable), variable.formula, variable.description);
  }
  if (!unexplained.variables.empty()) {
    const EmpiricalPredictor& first = unexplained.variables.front();
    say("{}\n", component_text(first));
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

}  // namespace pcor::tool
