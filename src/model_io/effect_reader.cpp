#include "model_io/effect_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <pcor/base/suggest.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/effects/static_surface.hpp>
#include <pcor/model/formula.hpp>
#include <pcor/units/units.hpp>

namespace pcor::internal {
namespace {

class EffectReader final : TomlReader {
 public:
  EffectReader(std::string_view name, ModelDefinition& file) : TomlReader(name), file_(file) {}

  void read(const Entry& effects) {
    const std::string requested = "each effect under a heading [[effect]]";
    for (const toml::node& node : array(effects, requested)) {
      read_effect(as<toml::table>(node, fmt::format("an effect is {}; give {}", kind_of(node), requested)));
    }
  }

 private:
  // The keys of one [[effect]] that were given.
  struct EffectEntries {
    std::optional<Entry> id, location, formula, scaling, parameters, unit, source, standard_errors, fixed,
        bounds, axes, coefficients;
  };

  void read_effect(const toml::table& table) {
    EffectEntries given;
    const auto keep = [](std::optional<Entry>& target) {
      return [&target](const Entry& entry) { target = entry; };
    };
    each(table, "[[effect]]",
         {{"id", keep(given.id)},
          {"where", keep(given.location)},
          {"formula", keep(given.formula)},
          {"scaling", keep(given.scaling)},
          {"parameters", keep(given.parameters)},
          {"unit", keep(given.unit)},
          {"source", keep(given.source)},
          {"stderr", keep(given.standard_errors)},
          {"fixed", keep(given.fixed)},
          {"bounds", keep(given.bounds)},
          {"axes", keep(given.axes)},
          {"coefficients", keep(given.coefficients)}});
    if (!given.id) fail(table, "an effect has no id; give id = \"...\"");
    const std::string id = text(*given.id);
    if (id.empty()) fail(*given.id->node, "the id of an effect is empty; give it a name");
    check_new(id, *given.id);

    ModelEffect effect = is_surface(id, given) ? surface(id, given)
                         : given.formula       ? formula_effect(id, given)
                                               : catalogue_effect(id, given);
    EffectFit fit = effect_fit(effect, given);
    file_.model.effects.push_back(std::move(effect));
    file_.fits.push_back(std::move(fit));
  }

  void check_new(const std::string& id, const Entry& entry) {
    const auto [first, is_new] = effect_lines_.emplace(id, entry.position.line);
    if (is_new) return;
    fail(entry,
         fmt::format("effect {} is in the model already, at line {}; remove one", quote(id), first->second));
  }

  static bool is_surface(const std::string& id, const EffectEntries& given) {
    return given.axes || given.coefficients || surface_named(id) != nullptr;
  }

  ModelEffect surface(const std::string& id, const EffectEntries& given) const {
    const std::string requested =
        "axes = { attack_ratio = [lower, upper], mach = [lower, upper] } and coefficients = [[...], ...], "
        "one "
        "row for each spline of the first axis";
    if (!given.axes || !given.coefficients)
      fail(*given.id->node,
           fmt::format("surface {} lacks its knots or coefficients; give {}", quote(id), requested));
    if (effect_named(id) != nullptr)
      fail(given.axes->position, fmt::format("effect {} has its formula in the catalogue; remove 'axes' and "
                                             "'coefficients', or choose another id",
                                             quote(id)));
    for (const std::optional<Entry>* entry :
         {&given.location, &given.unit, &given.source, &given.formula, &given.parameters, &given.scaling}) {
      if (*entry)
        fail((*entry)->position, fmt::format("a surface has no key '{}'; remove it", (*entry)->key));
    }
    std::vector<std::vector<double>> rows;
    for (const toml::node& node : array(*given.coefficients, requested)) {
      rows.push_back(numbers({given.coefficients->key, given.coefficients->position, &node, {}}, requested));
      if (rows.back().size() != rows.front().size())
        fail(node,
             fmt::format("this row has {} coefficients, the first row {}; give the same number in each row",
                         rows.back().size(), rows.front().size()));
    }
    const std::vector<Entry> axes = entries_of(table(*given.axes, requested), quote(given.axes->key));
    if (axes.size() != 2)
      fail(*given.axes, fmt::format("a surface has two axes, not {}; give {}", axes.size(), requested));
    std::array<SurfaceAxis, 2> made;
    for (std::size_t k = 0; k < made.size(); ++k) {
      const auto [lower, upper] = range(axes[k]);
      const std::size_t count = k == 0 ? rows.size() : rows.empty() ? 0 : rows.front().size();
      made[k] = {quantity_named(axes[k].key), lower, upper, count};
      if (made[k].quantity == Quantity::count)
        fail(axes[k].position,
             fmt::format("there is no quantity {}; give {}", quote(axes[k].key), requested));
      if (!made[k].is_valid())
        fail(*given.coefficients, fmt::format("{} has {} splines; give {} to {}", quote(axes[k].key), count,
                                              SurfaceAxis::min_count, SurfaceAxis::max_count));
    }
    ModelEffect effect = surface_effect(id, made);
    effect.parameters.clear();
    for (const std::vector<double>& row : rows)
      effect.parameters.insert(effect.parameters.end(), row.begin(), row.end());
    return effect;
  }

  ModelEffect catalogue_effect(const std::string& id, const EffectEntries& given) const {
    const EffectInfo* const info = effect_named(id);
    if (info == nullptr) {
      fail(*given.id->node,
           fmt::format(
               "there is no effect {} in the catalogue; {} Or give a formula for a user-defined effect",
               quote(id), full_stop(suggestion_text(id, names_of(effect_info, &EffectInfo::id)))));
    }
    for (const std::optional<Entry>* entry : {&given.location, &given.unit, &given.source}) {
      if (!*entry) continue;
      fail(
          (*entry)->position,
          fmt::format("effect {} of the catalogue has no key '{}'; remove it, or give a formula and a new id",
                      quote(id), (*entry)->key));
    }
    ModelEffect effect = neutral_effect(id);
    if (given.scaling) effect.scaling = scaling(*given.scaling);
    if (given.parameters) {
      each_parameter(*given.parameters, effect, [&](std::size_t i, const Entry& entry) {
        effect.parameters[i] = possible(entry, info->parameters[i]);
      });
    }
    return effect;
  }

  Scaling scaling(const Entry& entry) const {
    Scaling result;
    const std::string requested = "{ static_pressure = POWER, dynamic_pressure = POWER }";
    for (const Entry& power : entries_of(table(entry, requested), quote(entry.key))) {
      if (power.key == "static_pressure") {
        result.static_pressure = whole_power(power);
      } else if (power.key == "dynamic_pressure") {
        result.dynamic_pressure = whole_power(power);
      } else {
        fail(power.position,
             fmt::format("an effect is scaled by powers of the two pressures, not of {}; give {}",
                         quote(power.key), requested));
      }
    }
    return result;
  }

  int whole_power(const Entry& entry) const {
    const double power = number(entry);
    if (std::abs(power) > max_power || power != std::floor(power)) {
      fail(entry, fmt::format("scaling exponent {} is invalid; use an integer from {} to {}", power,
                              -max_power, max_power));
    }
    return static_cast<int>(power);
  }

  // A value that physics allows.
  double possible(const Entry& entry, const ParameterInfo& info) const {
    const double value = number(entry);
    if (value < info.lower || value > info.upper) {
      fail(entry,
           fmt::format("{} = {} is outside the bounds of the catalogue; give a value within [{}, {}]{}",
                       quote(entry.key), value, info.lower, info.upper,
                       info.unit == "1" ? "" : fmt::format(" {}", info.unit)));
    }
    return value;
  }

  static std::string full_stop(std::string text) {
    if (text.back() != '?') text += '.';
    return text;
  }

  ModelEffect formula_effect(const std::string& id, const EffectEntries& given) const {
    if (effect_named(id) != nullptr) {
      fail(given.formula->position,
           fmt::format("effect {} has its formula in the catalogue; remove 'formula', or give a new id",
                       quote(id)));
    }
    if (given.scaling) {
      fail(given.scaling->position,
           fmt::format("effect {} is defined by a formula; write the scaling into it", quote(id)));
    }
    ModelEffect effect;
    effect.id = id;
    effect.formula = text(*given.formula, "a formula in quotes");
    if (given.location) effect.location = place_of_action(*given.location);
    if (given.unit) effect.unit = unit_of_action(*given.unit, effect.location);
    if (given.source) effect.source = text(*given.source);
    if (!given.parameters) {
      fail(given.formula->position,
           fmt::format("effect {} has a formula but no parameters; give parameters = {{ "
                       "name = value }}, each with its first value",
                       quote(id)));
    }
    for (const Entry& entry : parameter_entries(*given.parameters)) {
      effect.parameter_names.push_back(entry.key);
      effect.parameters.push_back(number(entry));
    }
    check_formula(effect, given);
    return effect;
  }

  void check_formula(const ModelEffect& effect, const EffectEntries& given) const {
    FormulaError error;
    const auto formula = Formula::parse(effect.formula, effect.parameter_names, &error);
    if (!formula) {
      const Entry& wrong = error.column == 0 ? *given.parameters : *given.formula;
      fail(*wrong.node, fmt::format("the formula of effect {} cannot be read: {}; correct it",
                                    quote(effect.id), error.message));
    }
    if (effect.parameters.empty()) {
      fail(*given.formula->node,
           fmt::format(
               "the formula of effect {} has no coefficient; give it one in parameters, such as k, and "
               "multiply by it",
               quote(effect.id)));
    }
    if (formula->unused_parameters().empty()) return;
    const std::string& unused = formula->unused_parameters().front();
    const std::string meant = did_you_mean(unused, formula->variables());
    fail(*given.parameters->node,
         fmt::format("the formula of effect {} does not use its parameter {}; {}", quote(effect.id),
                     quote(unused), meant.empty() ? "remove the parameter" : meant));
  }

  EffectLocation place_of_action(const Entry& entry) const {
    const std::string name = text(entry);
    const EffectLocation location = location_named(name);
    if (location == EffectLocation::count) {
      fail(entry,
           fmt::format("unknown location {} of an effect; {}", quote(name),
                       suggestion_text(name, names_of(effect_location_info, &EffectLocationInfo::name))));
    }
    return location;
  }

  std::string unit_of_action(const Entry& entry, EffectLocation location) const {
    std::string unit = text(entry, "a unit in quotes");
    const std::string requested(info_of(location).unit);
    if (standard_unit(unit) != standard_unit(requested)) {
      fail(entry,
           fmt::format(
               "the quantity at '{}' is in {}, not in {}; write the formula in {} and set unit = \"{}\"",
               info_of(location).name, requested, quote(unit), requested, requested));
    }
    return unit;
  }

  std::vector<Entry> parameter_entries(const Entry& entry) const {
    return entries_of(table(entry, "{ name = value }"), quote(entry.key));
  }

  // Calls `action` with the number of each parameter that the table `entry` names.
  template <class Handler>
  void each_parameter(const Entry& entry, const ModelEffect& effect, const Handler& action) const {
    for (const Entry& parameter : parameter_entries(entry)) {
      action(parameter_number(parameter.key, parameter.position, effect), parameter);
    }
  }

  std::size_t parameter_number(const std::string& name, Position position, const ModelEffect& effect) const {
    const Names known = parameter_names(effect);
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      fail(position,
           fmt::format("effect {} has no parameter {}; {}", quote(effect.id), quote(name),
                       known.empty() ? "the effect has no parameters" : suggestion_text(name, known)));
    }
    return static_cast<std::size_t>(found - known.begin());
  }

  EffectFit effect_fit(const ModelEffect& effect, const EffectEntries& given) const {
    EffectFit fit(effect.parameters.size());
    if (given.standard_errors) {
      each_parameter(*given.standard_errors, effect, [&](std::size_t i, const Entry& entry) {
        const double value = number(entry);
        if (value < 0.0) {
          fail(entry, fmt::format("the standard error of {} is negative; give a number of 0 or above",
                                  quote(entry.key)));
        }
        fit[i].standard_error = value;
      });
    }
    if (given.bounds) {
      each_parameter(*given.bounds, effect, [&](std::size_t i, const Entry& entry) {
        const auto [lower, upper] = range(entry);
        const Bounds bounds{lower, upper};
        const double value = effect.parameters[i];
        if (value < bounds.lower || value > bounds.upper) {
          fail(entry, fmt::format("the value {} of {} is outside its bounds; change one of them", value,
                                  quote(entry.key)));
        }
        check_bounds(bounds, effect, i, entry);
        fit[i].bounds = bounds;
      });
    }
    if (given.fixed) read_fixed(*given.fixed, effect, fit);
    if (!effect.is_formula()) hold_shapes(effect, given, fit);
    return fit;
  }

  // A shape that the file does not mention has its default value, and a refit keeps it fixed.
  void hold_shapes(const ModelEffect& effect, const EffectEntries& given, EffectFit& fit) const {
    std::vector<bool> is_given(fit.size());
    if (given.parameters) {
      each_parameter(*given.parameters, effect, [&](std::size_t i, const Entry&) { is_given[i] = true; });
    }
    const EffectInfo& info = *effect_named(effect.id);
    for (std::size_t i = 0; i < fit.size(); ++i) {
      if (info.parameters[i].shape && !is_given[i]) fit[i].fixed = true;
    }
  }

  // A refit must stay within the bounds that the reader accepts.
  void check_bounds(const Bounds& bounds, const ModelEffect& effect, std::size_t number,
                    const Entry& entry) const {
    if (effect.is_formula()) return;
    const ParameterInfo& info = effect_named(effect.id)->parameters[number];
    if (bounds.lower >= info.lower && bounds.upper <= info.upper) return;
    fail(entry,
         fmt::format("the bounds of {} exceed the bounds of the catalogue; give bounds within [{}, {}]",
                     quote(entry.key), info.lower, info.upper));
  }

  void read_fixed(const Entry& entry, const ModelEffect& effect, EffectFit& fit) const {
    for (const auto& [node, name] : texts(entry, "the names of parameters, such as [\"a0\"]")) {
      ParameterFit& parameter = fit[parameter_number(name, node->source().begin, effect)];
      if (parameter.fixed) fail(*node, fmt::format("{} is named twice; remove one", quote(name)));
      parameter.fixed = true;
    }
  }

  ModelDefinition& file_;
  std::map<std::string, toml::source_index> effect_lines_;
};

}  // namespace

void read_effects(const Entry& effects, std::string_view name, ModelDefinition& file) {
  EffectReader(name, file).read(effects);
}

}  // namespace pcor::internal
