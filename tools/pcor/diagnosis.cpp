#include "diagnosis.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/base/suggest.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/effects/static_surface.hpp>
#include <pcor/model/formula.hpp>
#include <pcor/roles/add_effects.hpp>
#include "comparison.hpp"
#include "model_name.hpp"

namespace pcor::tool {
namespace {

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

double number_in(const std::string& text, const std::string& argument,
                 const char* required = "number; write NAME=NUMBER") {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, status] = std::from_chars(text.data(), end, value);
  if (status != std::errc() || rest != end)
    throw Error(Error::Code::usage, fmt::format("{}: '{}' is not a {}", argument, text, required));
  return value;
}

/// Value of a shape parameter; days since 2000-01-01 also as a date.
double value_of(const ParameterInfo& shape, const std::string& text, const std::string& argument) {
  if (shape.unit != "d") return number_in(text, argument);
  std::tm date{};
  const char* const rest = strptime(text.c_str(), "%Y-%m-%d", &date);
  const int day = date.tm_mday;
  const auto seconds = static_cast<double>(timegm(&date));  // changes 31 February to 3 March
  if (rest == nullptr || *rest != '\0' || date.tm_mday != day)
    return number_in(text, argument, "date; write NAME=YYYY-MM-DD or the days since 2000-01-01");
  constexpr double seconds_of_day = 86400.0, days_to_2000 = 10957.0;
  return seconds / seconds_of_day - days_to_2000;
}

constexpr std::pair<std::string_view, int Scaling::*> powers[]{
    {"static_pressure", &Scaling::static_pressure}, {"dynamic_pressure", &Scaling::dynamic_pressure}};

void set_shape(ModelEffect& effect, const std::string& name, const std::string& value,
               const std::string& argument) {
  for (const auto& [pressure, power] : powers) {
    if (name != pressure) continue;
    const double number = number_in(value, argument);
    if (number != std::floor(number) || std::abs(number) > max_power) {
      throw Error(Error::Code::usage, fmt::format("{}: a power must be a whole number from {} to {}, not {}",
                                                  argument, -max_power, max_power, value));
    }
    effect.scaling.*power = static_cast<int>(number);
    return;
  }
  const EffectInfo& info = *effect_named(effect.id);
  std::vector<std::string_view> shapes;
  for (std::size_t i = 0; i < info.parameter_count(); ++i) {
    if (!info.parameters[i].shape) continue;
    const ParameterInfo& shape = info.parameters[i];
    if (shape.name == name) {
      effect.parameters[i] = value_of(shape, value, argument);
      if (effect.parameters[i] >= shape.lower && effect.parameters[i] <= shape.upper) return;
      throw Error(Error::Code::usage, fmt::format("{}: {} = {} is outside [{}, {}]; give a value inside",
                                                  argument, name, value, shape.lower, shape.upper));
    }
    shapes.push_back(shape.name);
  }
  shapes.insert(shapes.end(), {"static_pressure", "dynamic_pressure"});
  throw Error(Error::Code::usage, fmt::format("{}: '{}' is not a shape parameter of the effect {}; use {}",
                                              argument, name, effect.id, fmt::join(shapes, ", ")));
}

}  // namespace

std::string argument_of(const ModelEffect& effect) {
  std::vector<std::string> shapes;
  if (!effect.is_formula()) {
    const EffectInfo& info = *effect_named(effect.id);
    for (std::size_t i = 0; i < info.parameter_count(); ++i) {
      const ParameterInfo& parameter = info.parameters[i];
      if (parameter.shape && effect.parameters[i] != parameter.typical)
        shapes.push_back(fmt::format("{}={}", parameter.name, effect.parameters[i]));
    }
  }
  for (const auto& [pressure, power] : powers) {
    if (effect.scaling.*power != 0) shapes.push_back(fmt::format("{}={}", pressure, effect.scaling.*power));
  }
  return effect.id + (shapes.empty() ? "" : ":") + fmt::format("{}", fmt::join(shapes, ","));
}

std::optional<ModelEffect> surface_argument(const std::string& argument, const Flight* flight,
                                            const ModelDefinition& model) {
  const std::size_t colon = argument.find(':');
  const std::string id = argument.substr(0, colon);
  if (surface_named(id) == nullptr) return std::nullopt;
  if (flight == nullptr)
    throw Error(Error::Code::usage,
                fmt::format("{}: the knots of a surface are chosen from a flight; give --flight IN.nc", id));
  const auto the_flight = [flight](std::size_t) -> const Flight& { return *flight; };
  if (colon == std::string::npos) return surface_over(1, the_flight, model, id);
  constexpr std::string_view requested = "splines=";
  const std::string shape = argument.substr(colon + 1);
  const double splines =
      shape.rfind(requested, 0) == 0 ? number_in(shape.substr(requested.size()), argument) : 0.0;
  if (!(splines >= SurfaceAxis::min_count && splines <= SurfaceAxis::max_count))
    throw Error(Error::Code::usage,
                fmt::format("{}: '{}' is not a key of a surface; give splines= and a number from {} to {}",
                            argument, shape, SurfaceAxis::min_count, SurfaceAxis::max_count));
  return surface_over(1, the_flight, model, id, static_cast<std::size_t>(splines));
}

ModelEffect shaped_effect(const std::string& argument) {
  std::istringstream text(argument);
  std::string id;
  std::getline(text, id, ':');
  ModelEffect effect = neutral_effect(id);
  for (std::string shape; std::getline(text, shape, ',');) {
    const std::size_t sign = shape.find('=');
    if (sign == std::string::npos)
      throw Error(Error::Code::usage,
                  fmt::format("{}: '{}' is not a shape; write {}:NAME=NUMBER", argument, shape, id));
    set_shape(effect, shape.substr(0, sign), shape.substr(sign + 1), argument);
  }
  if (id == effects::AircraftStep::info().id && argument.find("since=") == std::string::npos)
    throw Error(
        Error::Code::usage,
        fmt::format("{0}: the date of the change is missing; write, for example, {0}:since=2011-11-17", id));
  return effect;
}

void add_candidate_options(CLI::App& command, CandidateOptions& options) {
  add_list_option(command, "--try", options.formulas,
                  "test a user-defined effect too: its formula, hPa at the static ports, with a coefficient "
                  "k and variables by netCDF name or by role: 'k * ENGTRQ / 100'; in alphabetical order the "
                  "formulas are named try-1, try-2, ...")
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

std::vector<std::string> variables_of_any(const FlightSet& flights) {
  std::set<std::string> variables;
  for (const std::vector<std::string>& of_one : flights.variables())
    variables.insert(of_one.begin(), of_one.end());
  return {variables.begin(), variables.end()};
}

std::vector<ModelEffect> candidate_formulas(const CandidateOptions& options, const ModelDefinition& model,
                                            const FlightSet& flights) {
  std::vector<ModelEffect> candidates;
  const auto is_new = [&](const std::string& id) {
    const auto same = [&id](const ModelEffect& effect) { return effect.id == id; };
    return !has_effect(model, id) && std::none_of(candidates.begin(), candidates.end(), same);
  };
  if (!options.file.empty()) {
    const std::vector<ModelEffect> effects = read_model(options.file).model.effects;
    if (std::none_of(effects.begin(), effects.end(),
                     [](const ModelEffect& each) { return each.is_formula(); }))
      throw Error(Error::Code::usage,
                  fmt::format("--candidates {}: the model has no effect with a formula, so it adds no "
                              "candidate; give another model or omit the option",
                              options.file));
    for (const ModelEffect& effect : effects) {
      if (effect.is_formula() && is_new(effect.id)) candidates.push_back(effect);
    }
  }
  if (options.formulas.empty()) return candidates;
  const std::vector<std::string> variables = variables_of_any(flights);
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
  for (const std::string& formula : options.formulas) line += " " + shell_option("--try", formula);
  if (!options.file.empty()) line += " --candidates " + model_argument(options.file);
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

void print_unexplained(const Unexplained& unexplained) {
  if (!unexplained.significant) return;
  print_formatted("\nunexplained residual: {:.3f} hPa rms (p {}), including {:.3f} hPa of slow drift{}{}\n",
                  unexplained.rms, probability(unexplained.p_value), unexplained.drift_rms,
                  unexplained.regime.empty() ? "" : "; largest in ", unexplained.regime);
  if (!unexplained.variables.empty()) {
    print_formatted("{:<20} {:<10} {:>6} {:>8} {:>20}  {:<32} {}\n", "correlates with", "unit", "R2", "p",
                    "hPa per unit", "formula", "description");
    for (const EmpiricalPredictor& variable : unexplained.variables) {
      const std::string slope = variable.slope_error > 0.0
                                    ? fmt::format("{:.3g} +- {:.2g}", variable.slope, variable.slope_error)
                                    : "no linear trend";
      print_formatted("{:<20} {:<10} {:>6.3f} {:>8} {:>20}  {:<32} {}\n", variable.name, variable.unit,
                      variable.r2, probability(variable.p_value), slope, variable.formula,
                      variable.description);
    }
    print_formatted("{}\n", component_text(unexplained.variables.front()));
  }
  for (const FlightOffset& step : unexplained.steps) {
    print_formatted("{} lies {:.3f} +- {:.3f} hPa {} the rest of the flights (p {})\n", step.flight,
                    std::abs(step.size), step.standard_error, step.size < 0.0 ? "below" : "above",
                    probability(step.p_value));
  }
  const std::size_t untested = unexplained.computed.size() + unexplained.shares_noise.size();
  if (untested > 0) {
    print_formatted(
        "{} variables were not tested, because they derive from the inputs of the residual; --json and "
        "--report name them\n",
        untested);
  }
}

}  // namespace pcor::tool
