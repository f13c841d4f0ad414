#include <fmt/format.h>

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

struct Options {
  CommonOptions common;
  std::string id;
};

const EffectWithoutTrace* find_without_trace(const std::string& id) {
  const auto found = std::find_if(effects_without_trace.begin(), effects_without_trace.end(),
                                  [&id](const EffectWithoutTrace& effect) { return effect.id == id; });
  return found == effects_without_trace.end() ? nullptr : &*found;
}

const EffectInfo& find(const std::string& id) {
  const std::size_t place = effect_named(id);
  if (place < catalogue_size) return effect_info[place];
  if (const EffectInfo* const surface = surface_named(id)) return *surface;
  std::vector<std::string> ids;
  for (const EffectInfo& info : surface_info) ids.emplace_back(info.id);
  for (const EffectInfo& info : effect_info) ids.emplace_back(info.id);
  for (const EffectWithoutTrace& effect : effects_without_trace) ids.emplace_back(effect.id);
  const std::string hint = did_you_mean(id, ids);
  throw Error(fmt::format("there is no effect '{}'{}{} to list them: {} effects", id,
                          hint.empty() ? ";" : "; ", hint, program()));
}

std::string names_of_needs(const EffectInfo& info) {
  std::string names;
  for (std::size_t i = 0; i < info.need_count(); ++i) {
    if (i > 0) names += ", ";
    names += info_of(info.needs[i]).name;
  }
  return names.empty() ? "nothing" : names;
}

nlohmann::ordered_json as_json(const EffectInfo& info) {
  nlohmann::ordered_json effect;
  effect["id"] = info.id;
  effect["title"] = info.title;
  effect["family"] = info.family;
  effect["place"] = place_of(info);
  effect["where"] = info_of(info.location).name;
  effect["unit"] = info_of(info.location).unit;
  effect["formula"] = info.formula;
  effect["parameters"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < info.parameter_count(); ++i) {
    const ParameterInfo& parameter = info.parameters[i];
    effect["parameters"].push_back({{"name", parameter.name},
                                    {"unit", parameter.unit},
                                    {"neutral", parameter.neutral},
                                    {"bounds", {parameter.lower, parameter.upper}},
                                    {"typical", parameter.typical},
                                    {"shape", parameter.shape}});
  }
  effect["scalings"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < info.scaling_count(); ++i) {
    effect["scalings"].push_back({{"static_pressure", info.scalings[i].static_pressure},
                                  {"dynamic_pressure", info.scalings[i].dynamic_pressure}});
  }
  effect["needs"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < info.need_count(); ++i) effect["needs"].push_back(info_of(info.needs[i]).name);
  effect["size"] = info.size;
  effect["look_alikes"] = info.look_alikes;
  effect["manoeuvre"] = info.manoeuvre;
  effect["source"] = info.source;
  return effect;
}

nlohmann::ordered_json as_json(const EffectWithoutTrace& effect) {
  return {{"id", effect.id}, {"title", effect.title}, {"reason", effect.reason}};
}

std::string_view text_of(GasConstants constants) {
  return constants == GasConstants::dry ? "models with dry constants" : "models with moist constants";
}

void print_surface(const EffectInfo& info) {
  say("\nCp is a tensor product of uniform cubic B-splines, by default 6 x 6. A refit penalises its second "
      "differences, with a weight found by marginal likelihood. Outside the envelope of the knots Cp keeps "
      "the value of the edge, the sample has the quality bit outside_domain, and the stated error of delta-p "
      "grows.\n\n"
      "To add it: {} add {} -m MODEL.toml --flight IN.nc -o NEW.toml\n",
      program(), info.id);
}

void print_one(const EffectInfo& info) {
  const EffectLocationInfo& location = info_of(info.location);
  say("{}: {}\n\n", info.id, info.title);
  say("  family       {}\n  place        {}\n", info.family, place_of(info));
  say("  formula      {}  [{}]\n  acts on      {}\n", info.formula, location.unit, location.adds_to);
  for (std::size_t i = 0; i < info.parameter_count(); ++i) {
    const ParameterInfo& parameter = info.parameters[i];
    const std::string neutral =
        parameter.shape ? "shapes the effect" : fmt::format("neutral {}", parameter.neutral);
    say("  parameter    {}  [{}], {}, from {} to {}, typically {}\n", parameter.name, parameter.unit, neutral,
        parameter.lower, parameter.upper, parameter.typical);
  }
  for (std::size_t i = 0; i < info.scaling_count(); ++i) {
    say("  or scaled by (p/700 hPa)^{} (q/70 hPa)^{}\n", info.scalings[i].static_pressure,
        info.scalings[i].dynamic_pressure);
  }
  if (info.constants != GasConstants::any) say("  only in      {}\n", text_of(info.constants));
  say("  needs        {}\n", names_of_needs(info));
  say("  size         {}\n", info.size);
  say("  look-alikes  {}\n", info.look_alikes);
  say("  separated by {}\n", info.manoeuvre);
  say("  source       {}\n", info.source);
  if (info.parameter_count() == 0) return print_surface(info);
  say("  example      ");
  for (const auto& input : info.example.inputs) {
    if (input.quantity == Quantity::count) break;
    say("{} = {}, ", info_of(input.quantity).name, input.value);
  }
  std::string example;
  std::string typical;
  for (std::size_t i = 0; i < info.parameter_count(); ++i) {
    const std::string_view separator = i == 0 ? "" : ", ";
    example += fmt::format("{}{} = {}", separator, info.parameters[i].name, info.example.parameters[i]);
    typical += fmt::format("{}{} = {}", separator, info.parameters[i].name, info.parameters[i].typical);
  }
  say("{} gives {} {}\n\nIn a model file:\n\n", example, info.example.value, location.unit);
  say("  [[effect]]\n  id = \"{}\"\n  parameters = {{ {} }}\n", info.id, typical);
}

void print_all() {
  say("{:<18} {:<14} {:<13} {:<20} {:<70} {}\n", "effect", "family", "place", "where", "what", "formula");
  for (const EffectInfo& info : effect_info) {
    say("{:<18} {:<14} {:<13} {:<20} {:<70} {}\n", info.id, info.family, place_of(info),
        info_of(info.location).name, info.title, info.formula);
  }
  for (const EffectInfo& info : surface_info) {
    say("{:<18} {:<14} {:<13} {:<20} {:<70} {}\n", info.id, info.family, place_of(info),
        info_of(info.location).name, info.title, info.formula);
  }
  say("\nKnown errors that no term of a model can describe\n\n");
  for (const EffectWithoutTrace& effect : effects_without_trace) say("{:<22} {}\n", effect.id, effect.title);
  say("\n");
}

void run(const Options& options) {
  refuse_overwriting({options.common.json}, {});
  JsonResult json(options.common);
  if (const EffectWithoutTrace* const effect = find_without_trace(options.id)) {
    json.write(as_json(*effect));
    if (wants_text(options.common)) {
      say("{}: {}\n\nNo term of a model describes it: {}.\n", effect->id, effect->title, effect->reason);
      say_written({options.common.json});
    }
    return;
  }
  if (!options.id.empty()) {
    const EffectInfo& info = find(options.id);
    json.write(as_json(info));
    if (wants_text(options.common)) {
      print_one(info);
      say_written({options.common.json});
    }
    return;
  }
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const EffectInfo& info : effect_info) all.push_back(as_json(info));
  nlohmann::ordered_json without_trace = nlohmann::ordered_json::array();
  for (const EffectWithoutTrace& effect : effects_without_trace) without_trace.push_back(as_json(effect));
  nlohmann::ordered_json surfaces = nlohmann::ordered_json::array();
  for (const EffectInfo& info : surface_info) surfaces.push_back(as_json(info));
  json.write({{"effects", all}, {"surfaces", surfaces}, {"without_trace", without_trace}});
  if (!wants_text(options.common)) return;
  print_all();
  say_written({options.common.json});
  say("For details: {} effects {}\n", program(), effect_info.front().id);
}

}  // namespace

std::function<void()> add_effects(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("effects", "List the catalogue of effects, or describe one of them");
  command->add_option("id", options->id, "an effect, e.g. static-lag")->type_name("ID");
  add_common_options(*command, options->common, false);
  add_examples(*command, {"effects", "effects static-qp"});
  return [options] { run(*options); };
}

}  // namespace pcor::tool
