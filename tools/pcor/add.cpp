#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/roles/add_effects.hpp>
#include <pcor/units/units.hpp>
#include "command.hpp"
#include "comparison.hpp"
#include "diagnosis.hpp"
#include "model_selector.hpp"

namespace pcor::tool {
namespace {

struct AddArguments {
  CommonOptions common;
  std::vector<std::string> effects;
  std::string model;
  std::string output;
  std::string formula;
  std::string location = "static";
  std::string unit;
  std::string source;
  std::string flight;
};

/// User-defined effect. @throws Error if the options do not define one.
ModelEffect user_effect(const AddArguments& options, const std::vector<std::string>& variables) {
  if (options.effects.size() != 1) {
    throw Error(Error::Code::usage,
                fmt::format("--formula defines one effect, but {} are named: {}; give one name",
                            options.effects.size(), fmt::join(options.effects, ", ")));
  }
  ModelEffect effect = formula_effect(options.effects.front(), options.formula, "--formula");
  effect.location = location_named(options.location);
  const std::string requested(info_of(effect.location).unit);
  if (!options.unit.empty() && standard_unit(options.unit) != standard_unit(requested)) {
    throw Error(Error::Code::usage,
                fmt::format("--unit {}: the quantity at '{}' is in {}; write the formula in {}", options.unit,
                            options.location, requested, requested));
  }
  effect.unit = requested;
  effect.source = options.source;
  if (!variables.empty()) require_known_variables(effect, "--formula", variables, options.flight);
  return effect;
}

/// GPS heights determine it, delta-p does not.
bool is_fitted_by_temperature(const ModelEffect& effect) {
  return effect.id == pcor::effects::TempCalibration::info().id;
}

/// JSON result of the command.
struct Extension {
  std::vector<ModelEffect> added{};
  Named<std::string> variables{};
  std::string model{};
};

template <class Field>
void describe(const Extension& self, Field& field) {
  field.list("added", self.added, "added effects", [](const ModelEffect& effect, Field& added) {
    added("effect", effect.id, "id of the effect");
    describe(effect, added);
  });
  field("variables", self.variables, "variable selected for each new role");
  field("model", self.model, "file of the extended model");
}

void print(const ModelDefinition& extended, const Extension& extension, const AddArguments& options) {
  print_formatted("{:<20} {:<15} {:<48} {}\n", "added", "where", "formula", "starts at");
  const std::size_t count = extended.model.effects.size();
  for (std::size_t i = count - extension.added.size(); i < count; ++i) {
    const ModelEffect& effect = extended.model.effects[i];
    const EffectInfo* info = effect.is_formula() ? nullptr : effect_named(effect.id);
    std::vector<std::string> start;
    if (effect.is_surface()) {
      const auto& axes = effect.surface->axes;
      start.push_back(fmt::format("zero, {} x {} splines", axes[0].count, axes[1].count));
      for (const SurfaceAxis& axis : axes)
        start.push_back(
            fmt::format("{} from {:.4g} to {:.4g}", info_of(axis.quantity).name, axis.lower, axis.upper));
    } else {
      const std::vector<std::string> names = parameter_names(effect);
      for (std::size_t k = 0; k < names.size(); ++k)
        start.push_back(fmt::format("{} = {}{}", names[k], effect.parameters[k],
                                    extended.fit(i, k).fixed ? " (fixed)" : ""));
    }
    std::string formula = info ? std::string(info->formula) : effect.formula;
    if (!effect.scaling.is_none()) formula = fmt::format("({})", formula);
    for (const auto& [pressure, power] : {std::pair("p/700 hPa", effect.scaling.static_pressure),
                                          std::pair("q/70 hPa", effect.scaling.dynamic_pressure)}) {
      if (power != 0) formula += fmt::format(" * ({})^{}", pressure, power);
    }
    print_formatted("{:<20} {:<15} {:<48} {}\n", effect.id,
                    info_of(info ? info->location : effect.location).name, formula, fmt::join(start, ", "));
  }
  for (const auto& [role, variable] : extension.variables)
    print_formatted("variable selected: {} = \"{}\"\n", role, variable);
  print_formatted("\n");
  print_written_files({options.output, options.common.json});
  const bool has_laser = extended.variables.count(Quantity::lams_airspeed) != 0;
  const std::string flight = options.flight.empty() ? "IN.nc" : shell_path(options.flight);
  const std::vector<ModelEffect>& added = extension.added;
  if (std::any_of(added.begin(), added.end(), is_fitted_by_temperature))
    print_formatted("To fit the calibration of the temperature: {} temperature {} -m {} -o {}\n", program(),
                    flight, shell_path(options.output),
                    output_file("calibrated.toml", {options.model, options.output}));
  if (std::all_of(added.begin(), added.end(), is_fitted_by_temperature)) return;
  print_formatted("To fit it: {} refit {} -m {}{} -o {}\n", program(), flight, shell_path(options.output),
                  has_laser ? "" : " --reference static:OTHER.toml",
                  output_file("fitted.toml", {options.model, options.output}));
}

void run(const AddArguments& options) {
  const std::vector<std::filesystem::path> inputs{options.model, options.flight};
  refuse_overwriting({options.output, options.common.json}, inputs);
  require_writable(options.output);
  JsonResult json(options.common);
  const FlightSet flights = options.flight.empty() ? FlightSet() : FlightSet{options.flight};
  const ModelDefinition model = read_model_for(options.model, flights, options.common);
  if (model.variables.count(Quantity::static_pressure) == 0) {
    throw Error(Error::Code::usage,
                fmt::format("{}: the model leaves its variables to the flight; give one with --flight",
                            options.model));
  }
  const Flight* const flight = flights.empty() ? nullptr : &flights[0];
  const std::vector<std::string> variables =
      flight == nullptr ? std::vector<std::string>() : flight->variables();
  std::vector<ModelEffect> effects;
  if (!options.formula.empty()) {
    effects.push_back(user_effect(options, variables));
  } else {
    for (const std::string& id : options.effects) {
      const std::optional<ModelEffect> surface = surface_argument(id, flight, model);
      effects.push_back(surface ? *surface : shaped_effect(id));
    }
  }
  ModelDefinition extended = add_effects(model, effects, variables, flight);
  for (std::size_t i = model.model.effects.size(); i < extended.model.effects.size(); ++i) {
    if (!is_fitted_by_temperature(extended.model.effects[i])) continue;
    for (ParameterFit& each : extended.fits[i]) each.fixed = true;
  }
  OutputTransaction together;
  write_model_output(extended, options.output, inputs);
  const auto first_added = static_cast<std::ptrdiff_t>(model.model.effects.size());
  Extension extension{
      {extended.model.effects.begin() + first_added, extended.model.effects.end()}, {}, options.output};
  for (const Quantity role : extended.roles()) {
    if (model.variables.count(role) == 0)
      extension.variables.emplace_back(info_of(role).name, extended.variables.at(role));
  }
  json.write(extension);
  together.appear();
  if (wants_text(options.common, {options.output})) print(extended, extension, options);
}

}  // namespace

std::function<void()> add_add(CLI::App& program) {
  auto options = std::make_shared<AddArguments>();
  CLI::App* command = program.add_subcommand(
      "add", "Add effects with neutral coefficients to a model, for a subsequent refit");
  command
      ->add_option(
          "effects", options->effects,
          "effects of the catalogue, with their shape or scaling if it differs from the default, such "
          "as static-transonic:onset=0.8, aircraft-step:since=2011-11-17 or "
          "static-mach:static_pressure=-1,dynamic_pressure=1 (powers of p/700 hPa and q/70 hPa); or "
          "static-surface, static-surface-beta; or with --formula "
          "the name of a user-defined effect")
      ->required()
      ->type_name("EFFECT...");
  command->add_option("-m,--model", options->model, "the model to extend")
      ->required()
      ->type_name("MODEL.toml");
  command->add_option("-o,--output", options->output, "output model (written atomically); - for stdout")
      ->required()
      ->type_name("NEW.toml");
  std::vector<std::string> locations;
  for (const EffectLocationInfo& info : effect_location_info) locations.emplace_back(info.name);
  CLI::Option* formula = command
                             ->add_option("--formula", options->formula,
                                          "formula of a user-defined effect, with a coefficient k and "
                                          "variables by netCDF name or by role: 'k * ENGTRQ / 100'")
                             ->type_name("FORMULA");
  command->add_option("--where", options->location, "the stage of the measurement at which the formula acts")
      ->check(CLI::IsMember(locations))
      ->needs(formula)
      ->capture_default_str();
  command->add_option("--unit", options->unit, "unit of the formula's value")
      ->needs(formula)
      ->type_name("UNIT");
  command->add_option("--source", options->source, "source of the formula")
      ->needs(formula)
      ->type_name("TEXT");
  command
      ->add_option("--flight", options->flight,
                   "choose the variables that the effects need among those of this flight, and choose the "
                   "knots of a surface from the range of this flight")
      ->type_name("IN.nc");
  add_common_options<Extension>(*command, options->common, false);
  add_examples(*command,
               {"add static-lag -m fitted.toml --flight first.nc -o extended.toml",
                "add static-surface -m fitted.toml --flight first.nc -o extended.toml",
                "add my-thrust --formula 'k * (ENGTRQ - 50) / 100' -m fitted.toml -o my-model.toml"});
  return [options] { run(*options); };
}

}  // namespace pcor::tool
