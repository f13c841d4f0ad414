#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/base/suggest.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/effects/static_surface.hpp>
#include <pcor/effects/without_trace.hpp>
#include "command.hpp"

namespace pcor::tool {
namespace {

struct EffectsArguments {
  CommonOptions common;
  std::string id;
};

const EffectInfo& find(const std::string& id) {
  if (const EffectInfo* const effect = effect_named(id)) return *effect;
  if (const EffectInfo* const surface = surface_named(id)) return *surface;
  std::vector<std::string> ids;
  for (const EffectInfo& info : surface_info) ids.emplace_back(info.id);
  for (const EffectInfo& info : effect_info) ids.emplace_back(info.id);
  for (const EffectWithoutTrace& effect : effects_without_trace) ids.emplace_back(effect.id);
  const std::string hint = did_you_mean(id, ids);
  throw Error(Error::Code::usage,
              fmt::format("the catalogue has no effect '{}' (only a model file describes an effect with a "
                          "formula){}{} to list the catalogue: {} effects",
                          id, hint.empty() ? ";" : "; ", hint, program()));
}

std::vector<std::string_view> names_of_needs(const EffectInfo& info) {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < info.need_count(); ++i) names.push_back(info_of(info.needs[i]).name);
  return names;
}

/// Effect of the catalogue in JSON.
struct CatalogueEntry {
  EffectInfo info{};
};

template <class Field>
void describe(const CatalogueEntry& self, Field& field) {
  const EffectInfo& info = self.info;
  const auto& parameters = info.parameters;
  field("id", info.id, "id of the effect");
  field("title", info.title, "title of the effect");
  field("family", info.family, "group of its alternative shapes and locations");
  field("place", component_of(info), "instrument component");
  field("where", info_of(info.location).name, "stage of the measurement");
  field("unit", info_of(info.location).unit, "unit of the effect");
  field("formula", info.formula, "formula of the effect");
  field.list("parameters", std::vector(parameters.begin(), parameters.begin() + info.parameter_count()),
             "coefficients", [](const ParameterInfo& parameter, Field& of_one) {
               of_one("name", parameter.name, "name of the coefficient");
               of_one("unit", parameter.unit, "unit of the coefficient");
               of_one("neutral", parameter.neutral, "value without an effect", "see unit");
               of_one("bounds", std::vector<double>{parameter.lower, parameter.upper}, "physical bounds",
                      "see unit");
               of_one("typical", parameter.typical, "typical size", "see unit");
               of_one("shape", parameter.shape, "whether the coefficient only shapes the effect");
             });
  field.list("scalings", std::vector(info.scalings.begin(), info.scalings.begin() + info.scaling_count()),
             "alternative scalings", [](const Scaling& scaling, Field& of_one) {
               of_one("static_pressure", scaling.static_pressure, "power of p/700 hPa");
               of_one("dynamic_pressure", scaling.dynamic_pressure, "power of q/70 hPa");
             });
  field("needs", names_of_needs(info), "roles and derived quantities that the effect reads");
  field("size", info.size, "typical size");
  field("look_alikes", info.confounders, "confounded effects");
  field("manoeuvre", info.manoeuvre, "manoeuvre that separates the effect from them");
  field("source", info.source, "source of formula and size");
}

/// JSON result without an id.
struct Catalogue {};

template <class Field>
void describe(const Catalogue& /*self*/, Field& field) {
  const auto entry = [](const EffectInfo& info, Field& of_one) { describe(CatalogueEntry{info}, of_one); };
  field.list("effects", effect_info, "effects of the catalogue", entry);
  field.list("surfaces", surface_info, "surfaces", entry);
  field("without_trace", effects_without_trace, "known effects that no term of a model describes");
}

void print_surface(const EffectInfo& info) {
  print_formatted(
      "\nCp is a tensor product of uniform cubic B-splines, by default 6 x 6. A refit penalises its second "
      "differences, with a weight found by marginal likelihood. Outside the envelope of the knots Cp keeps "
      "the value of the edge, the sample has the quality bit outside_domain, and the stated error of delta-p "
      "grows.\n\n"
      "To add it: {} add {} -m MODEL.toml --flight IN.nc -o NEW.toml\n",
      program(), info.id);
}

void print_one(const EffectInfo& info) {
  const EffectLocationInfo& location = info_of(info.location);
  print_formatted("{}: {}\n\n", info.id, info.title);
  print_formatted("  family       {}\n  place        {}\n", info.family, component_of(info));
  print_formatted("  formula      {}  [{}]\n  acts on      {}\n", info.formula, location.unit,
                  location.adds_to);
  for (std::size_t i = 0; i < info.parameter_count(); ++i) {
    const ParameterInfo& parameter = info.parameters[i];
    const std::string neutral =
        parameter.shape ? "shapes the effect" : fmt::format("neutral {}", parameter.neutral);
    print_formatted("  parameter    {}  [{}], {}, from {} to {}, typically {}\n", parameter.name,
                    parameter.unit, neutral, parameter.lower, parameter.upper, parameter.typical);
  }
  for (std::size_t i = 0; i < info.scaling_count(); ++i) {
    print_formatted("  or scaled by (p/700 hPa)^{} (q/70 hPa)^{}\n", info.scalings[i].static_pressure,
                    info.scalings[i].dynamic_pressure);
  }
  if (info.constants != GasConstants::any)
    print_formatted("  only in      models with {} constants\n",
                    info.constants == GasConstants::dry ? "dry" : "moist");
  print_formatted("  needs        {}\n", info.need_count() == 0
                                             ? "nothing"
                                             : fmt::format("{}", fmt::join(names_of_needs(info), ", ")));
  print_formatted("  size         {}\n", info.size);
  print_formatted("  confounders  {}\n", info.confounders);
  print_formatted("  separated by {}\n", info.manoeuvre);
  print_formatted("  source       {}\n", info.source);
  if (info.parameter_count() == 0) return print_surface(info);
  print_formatted("  example      ");
  for (const auto& input : info.example.inputs) {
    if (input.quantity == Quantity::count) break;
    print_formatted("{} = {}, ", info_of(input.quantity).name, input.value);
  }
  std::vector<std::string> example;
  std::vector<std::string> typical;
  for (std::size_t i = 0; i < info.parameter_count(); ++i) {
    example.push_back(fmt::format("{} = {}", info.parameters[i].name, info.example.parameters[i]));
    typical.push_back(fmt::format("{} = {}", info.parameters[i].name, info.parameters[i].typical));
  }
  print_formatted("{} gives {} {}\n\nIn a model file:\n\n", fmt::join(example, ", "), info.example.value,
                  location.unit);
  print_formatted("  [[effect]]\n  id = \"{}\"\n  parameters = {{ {} }}\n", info.id,
                  fmt::join(typical, ", "));
}

/// Effects of each component of the instrument.
void print_short() {
  std::vector<std::pair<std::string_view, std::vector<std::string_view>>> places;
  const auto add = [&places](std::string_view place, std::string_view id) {
    const auto found =
        std::find_if(places.begin(), places.end(), [place](const auto& each) { return each.first == place; });
    if (found != places.end())
      found->second.push_back(id);
    else
      places.push_back({place, {id}});
  };
  for (const EffectInfo& info : effect_info) add(component_of(info), info.id);
  for (const EffectInfo& info : surface_info) add(component_of(info), info.id);
  print_formatted("{:<14} effects\n", "place");
  for (const auto& [place, ids] : places) print_formatted("{:<14} {}\n", place, fmt::join(ids, ", "));
  print_formatted("{} known errors that no term of a model can describe, and all formulas: add --verbose\n",
                  std::size(effects_without_trace));
}

void print_all() {
  print_formatted("{:<18} {:<14} {:<13} {:<20} {:<70} {}\n", "effect", "family", "place", "where", "what",
                  "formula");
  const auto print_row = [](const EffectInfo& info) {
    print_formatted("{:<18} {:<14} {:<13} {:<20} {:<70} {}\n", info.id, info.family, component_of(info),
                    info_of(info.location).name, info.title, info.formula);
  };
  for (const EffectInfo& info : effect_info) print_row(info);
  for (const EffectInfo& info : surface_info) print_row(info);
  print_formatted("\nKnown errors that no term of a model can describe\n\n");
  for (const EffectWithoutTrace& effect : effects_without_trace)
    print_formatted("{:<22} {}\n", effect.id, effect.title);
  print_formatted("\n");
}

void run(const EffectsArguments& options) {
  refuse_overwriting({options.common.json}, {});
  JsonResult json(options.common);
  const bool says = wants_text(options.common);
  const auto without_trace =
      std::find_if(effects_without_trace.begin(), effects_without_trace.end(),
                   [&options](const EffectWithoutTrace& effect) { return effect.id == options.id; });
  if (without_trace != effects_without_trace.end()) {
    json.write(*without_trace);
    if (says)
      print_formatted("{}: {}\n\nNo term of a model describes it: {}.\n", without_trace->id,
                      without_trace->title, without_trace->reason);
  } else if (!options.id.empty()) {
    const EffectInfo& info = find(options.id);
    json.write(CatalogueEntry{info});
    if (says) print_one(info);
  } else {
    json.write(Catalogue());
    if (says) is_verbose() ? print_all() : print_short();
  }
  if (!says) return;
  print_written_files({options.common.json});
  if (options.id.empty()) print_formatted("For details: {} effects {}\n", program(), effect_info.front().id);
}

}  // namespace

std::function<void()> add_effects(CLI::App& program) {
  auto options = std::make_shared<EffectsArguments>();
  CLI::App* command =
      program.add_subcommand("effects", "List the catalogue of effects, or describe one of them");
  command->add_option("id", options->id, "an effect, e.g. static-lag")->type_name("ID");
  add_common_options(*command, options->common, false, [] {
    return KeyLists{json_keys(CatalogueEntry{}), json_keys(EffectWithoutTrace{}), json_keys(Catalogue{})};
  });
  add_examples(*command, {"effects", "effects static-qp"});
  return [options] { run(*options); };
}

}  // namespace pcor::tool
