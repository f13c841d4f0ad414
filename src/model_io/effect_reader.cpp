#include "model_io/effect_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>

#include <pcor/base/suggest.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/effects/static_surface.hpp>
#include <pcor/model/formula.hpp>
#include <pcor/units/units.hpp>
#include "model_io/model_names.hpp"

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
  // The entries of one [[effect]] by their keys.
  using Given = std::map<std::string, Entry>;

  static const Entry* find(const Given& given, const char* key) {
    const auto found = given.find(key);
    return found == given.end() ? nullptr : &found->second;
  }

  void read_effect(const toml::table& table) {
    refuse_unknown(table, "[[effect]]",
                   {"id", "where", "formula", "scaling", "parameters", "unit", "source", "stderr", "fixed",
                    "bounds", "axes", "coefficients"});
    Given given;
    for (const Entry& entry : entries_of(table, "[[effect]]")) given.emplace(entry.key, entry);
    const Entry* const id_entry = find(given, "id");
    if (id_entry == nullptr) fail(table, "an effect has no id; give id = \"...\"");
    const std::string id = text(*id_entry);
    if (id.empty()) fail(*id_entry->node, "the id of an effect is empty; give it a name");
    check_new(id, *id_entry);
    ModelEffect effect = is_surface(id, given)         ? surface(id, given)
                         : given.count("formula") != 0 ? formula_effect(id, given)
                                                       : catalogue_effect(id, given);
    EffectFit fit = effect_fit(effect, given);
    file_.model.effects.push_back(std::move(effect));
    file_.fits.push_back(std::move(fit));
  }

  void check_new(const std::string& id, const Entry& entry) {
    const auto [first, is_new] = effect_lines_.emplace(id, entry.position.line);
    if (is_new) return;
    fail(entry, "effect {} is in the model already, at line {}; remove one", quote(id), first->second);
  }

  static bool is_surface(const std::string& id, const Given& given) {
    return given.count("axes") != 0 || given.count("coefficients") != 0 || surface_named(id) != nullptr;
  }

  ModelEffect surface(const std::string& id, const Given& given) const {
    const std::string requested =
        "axes = { attack_ratio = [lower, upper], mach = [lower, upper] } and coefficients = [[...], ...], "
        "one row for each spline of the first axis";
    const Entry* const axes_entry = find(given, "axes");
    const Entry* const coefficients = find(given, "coefficients");
    if (axes_entry == nullptr || coefficients == nullptr)
      fail(*given.at("id").node, "surface {} lacks its knots or coefficients; give {}", quote(id), requested);
    if (effect_named(id) != nullptr)
      fail(axes_entry->position,
           "effect {} has its formula in the catalogue; remove 'axes' and "
           "'coefficients', or choose another id",
           quote(id));
    for (const char* const key : {"where", "unit", "source", "formula", "parameters", "scaling"}) {
      if (const Entry* const entry = find(given, key))
        fail(entry->position, "a surface has no key '{}'; remove it", key);
    }
    std::vector<std::vector<double>> rows;
    for (const toml::node& node : array(*coefficients, requested)) {
      rows.push_back(numbers({coefficients->key, coefficients->position, &node, {}}, requested));
      if (rows.back().size() != rows.front().size())
        fail(node, "this row has {} coefficients, the first row {}; give the same number in each row",
             rows.back().size(), rows.front().size());
    }
    const std::vector<Entry> axes = entries_of(table(*axes_entry, requested), quote(axes_entry->key));
    if (axes.size() != 2)
      fail(*axes_entry, "a surface has two axes, not {}; give {}", axes.size(), requested);
    std::array<SurfaceAxis, 2> made;
    for (std::size_t k = 0; k < made.size(); ++k) {
      const auto [lower, upper] = range(axes[k]);
      const std::size_t count = k == 0 ? rows.size() : rows.empty() ? 0 : rows.front().size();
      made[k] = {quantity_named(axes[k].key), lower, upper, count};
      if (made[k].quantity == Quantity::count)
        fail(axes[k].position, "there is no quantity {}; give {}", quote(axes[k].key), requested);
      if (!made[k].is_valid())
        fail(*coefficients, "'coefficients' has {} {}, one for each spline of {}; give {} to {}", count,
             k == 0 ? "rows" : "columns", quote(axes[k].key), SurfaceAxis::min_count, SurfaceAxis::max_count);
    }
    ModelEffect effect = surface_effect(id, made);
    effect.parameters.clear();
    for (const std::vector<double>& row : rows)
      effect.parameters.insert(effect.parameters.end(), row.begin(), row.end());
    return effect;
  }

  ModelEffect catalogue_effect(const std::string& id, const Given& given) const {
    const EffectInfo* const info = effect_named(id);
    if (info == nullptr) {
      fail(*given.at("id").node,
           "there is no effect {} in the catalogue; {} Or give a formula for a user-defined effect",
           quote(id), full_stop(suggestion_text(id, names_of(effect_info, &EffectInfo::id))));
    }
    for (const char* const key : {"where", "unit", "source"}) {
      if (const Entry* const entry = find(given, key))
        fail(entry->position,
             "effect {} of the catalogue has no key '{}'; remove it, or give a formula and a new id",
             quote(id), key);
    }
    ModelEffect effect = neutral_effect(id);
    if (const Entry* const entry = find(given, "scaling")) effect.scaling = scaling(*entry);
    if (const Entry* const parameters = find(given, "parameters")) {
      each_parameter(*parameters, effect, [&](std::size_t i, const Entry& entry) {
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
        fail(power.position, "an effect is scaled by powers of the two pressures, not of {}; give {}",
             quote(power.key), requested);
      }
    }
    return result;
  }

  int whole_power(const Entry& entry) const {
    const double power = number(entry);
    if (std::abs(power) > max_power || power != std::floor(power)) {
      fail(entry, "scaling exponent {} is invalid; use an integer from {} to {}", power, -max_power,
           max_power);
    }
    return static_cast<int>(power);
  }

  // A value that physics allows.
  double possible(const Entry& entry, const ParameterInfo& info) const {
    const double value = number(entry);
    if (!info.allows(value)) {
      fail(entry, "{} = {} is outside the bounds of the catalogue; give a value within [{}, {}]{}",
           quote(entry.key), value, info.lower, info.upper,
           info.unit == "1" ? "" : fmt::format(" {}", info.unit));
    }
    return value;
  }

  static std::string full_stop(std::string text) {
    if (text.back() != '?') text += '.';
    return text;
  }

  ModelEffect formula_effect(const std::string& id, const Given& given) const {
    const Entry& formula = given.at("formula");
    if (effect_named(id) != nullptr) {
      fail(formula.position, "effect {} has its formula in the catalogue; remove 'formula', or give a new id",
           quote(id));
    }
    if (const Entry* const entry = find(given, "scaling")) {
      fail(entry->position, "effect {} is defined by a formula; write the scaling into it", quote(id));
    }
    ModelEffect effect;
    effect.id = id;
    effect.formula = text(formula, "a formula in quotes");
    if (const Entry* const entry = find(given, "where")) effect.location = place_of_action(*entry);
    if (const Entry* const entry = find(given, "unit")) effect.unit = unit_of_action(*entry, effect.location);
    if (const Entry* const entry = find(given, "source")) effect.source = text(*entry);
    const Entry* const parameters = find(given, "parameters");
    if (parameters == nullptr) {
      fail(formula.position,
           "effect {} has a formula but no parameters; give parameters = {{ "
           "name = value }}, each with its first value",
           quote(id));
    }
    for (const Entry& entry : parameter_entries(*parameters)) {
      effect.parameter_names.push_back(entry.key);
      effect.parameters.push_back(number(entry));
    }
    name_roles(variables_of(effect, formula, *parameters), *parameters, effect);
    return effect;
  }

  // Variables of a formula, which is checked.
  Names variables_of(const ModelEffect& effect, const Entry& formula_entry, const Entry& parameters) const {
    FormulaError error;
    const auto formula = Formula::parse(effect.formula, effect.parameter_names, &error);
    if (!formula) {
      const Entry& wrong = error.column == 0 ? parameters : formula_entry;
      fail(*wrong.node, "the formula of effect {} cannot be read: {}; correct it", quote(effect.id),
           error.message);
    }
    if (effect.parameters.empty()) {
      fail(*formula_entry.node,
           "the formula of effect {} has no coefficient; give it one in parameters, such as k, and "
           "multiply by it",
           quote(effect.id));
    }
    if (formula->unused_parameters().empty()) return formula->variables();
    const std::string& unused = formula->unused_parameters().front();
    const std::string meant = did_you_mean(unused, formula->variables());
    fail(*parameters.node, "the formula of effect {} does not use its parameter {}; {}", quote(effect.id),
         quote(unused), meant.empty() ? "remove the parameter" : meant);
  }

  // Replaces variables of roles by the names of the roles: a loop knows no other names.
  void name_roles(const Names& variables, const Entry& parameters, ModelEffect& effect) const {
    for (const std::string& name : variables) {
      const Quantity role = role_of_variable(file_, name);
      if (role == Quantity::count) continue;
      const std::string role_name(info_of(role).name);
      const Names& names = effect.parameter_names;
      if (std::find(names.begin(), names.end(), role_name) != names.end()) {
        fail(*parameters.node, "{} is a parameter of effect {} and the role of {}; rename the parameter",
             quote(role_name), quote(effect.id), name);
      }
      // A character after a digit or a point belongs to a number, as in 1.E5.
      const std::regex word("(^|[^A-Za-z0-9_.])" + name + "(?![A-Za-z0-9_])");
      effect.formula = std::regex_replace(effect.formula, word, "$1" + role_name);
    }
  }

  EffectLocation place_of_action(const Entry& entry) const {
    const std::string name = text(entry);
    const EffectLocation location = location_named(name);
    if (location == EffectLocation::count) {
      fail(entry, "unknown location {} of an effect; {}", quote(name),
           suggestion_text(name, names_of(effect_location_info, &EffectLocationInfo::name)));
    }
    return location;
  }

  std::string unit_of_action(const Entry& entry, EffectLocation location) const {
    std::string unit = text(entry, "a unit in quotes");
    const std::string requested(info_of(location).unit);
    if (standard_unit(unit) != standard_unit(requested)) {
      fail(entry, "the quantity at '{}' is in {}, not in {}; write the formula in {} and set unit = \"{}\"",
           info_of(location).name, requested, quote(unit), requested, requested);
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
      fail(position, "effect {} has no parameter {}; {}", quote(effect.id), quote(name),
           known.empty() ? "the effect has no parameters" : suggestion_text(name, known));
    }
    return static_cast<std::size_t>(found - known.begin());
  }

  EffectFit effect_fit(const ModelEffect& effect, const Given& given) const {
    EffectFit fit(effect.parameters.size());
    if (const Entry* const errors = find(given, "stderr")) {
      each_parameter(*errors, effect, [&](std::size_t i, const Entry& entry) {
        const double value = number(entry);
        if (value < 0.0) {
          fail(entry, "the standard error of {} is negative; give a number of 0 or above", quote(entry.key));
        }
        fit[i].standard_error = value;
      });
    }
    if (const Entry* const all_bounds = find(given, "bounds")) {
      each_parameter(*all_bounds, effect, [&](std::size_t i, const Entry& entry) {
        const auto [lower, upper] = range(entry);
        const double value = effect.parameters[i];
        if (value < lower || value > upper) {
          fail(entry, "the value {} of {} is outside its bounds; change one of them", value,
               quote(entry.key));
        }
        // A refit must stay within the bounds that the reader accepts.
        const EffectInfo* const info = effect.is_formula() ? nullptr : effect_named(effect.id);
        if (info != nullptr && (lower < info->parameters[i].lower || upper > info->parameters[i].upper)) {
          fail(entry, "the bounds of {} exceed the bounds of the catalogue; give bounds within [{}, {}]",
               quote(entry.key), info->parameters[i].lower, info->parameters[i].upper);
        }
        fit[i].bounds = Bounds{lower, upper};
      });
    }
    if (const Entry* const fixed = find(given, "fixed")) read_fixed(*fixed, effect, fit);
    if (!effect.is_formula()) hold_shapes(effect, given, fit);
    return fit;
  }

  // A shape that the file does not mention has its default value, and a refit keeps it fixed.
  void hold_shapes(const ModelEffect& effect, const Given& given, EffectFit& fit) const {
    std::vector<bool> is_given(fit.size());
    if (const Entry* const parameters = find(given, "parameters"))
      each_parameter(*parameters, effect, [&](std::size_t i, const Entry&) { is_given[i] = true; });
    const EffectInfo& info = *effect_named(effect.id);
    for (std::size_t i = 0; i < fit.size(); ++i) {
      if (info.parameters[i].shape && !is_given[i]) fit[i].fixed = true;
    }
  }

  void read_fixed(const Entry& entry, const ModelEffect& effect, EffectFit& fit) const {
    for (const auto& [node, name] : texts(entry, "the names of parameters, such as [\"a0\"]")) {
      ParameterFit& parameter = fit[parameter_number(name, node->source().begin, effect)];
      if (parameter.fixed) fail(*node, "{} is named twice; remove one", quote(name));
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
