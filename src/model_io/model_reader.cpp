#include <pcor/model_io/model_definition.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <locale>
#include <sstream>

#include <pcor/base/error.hpp>
#include <pcor/physics/lams.hpp>
#include <pcor/units/units.hpp>

#include "base/toml_reader.hpp"
#include "model_io/effect_reader.hpp"
#include "model_io/model_names.hpp"
#include "model_io/output_table.hpp"
#include "model_io/sensor_uncertainty.hpp"

namespace pcor {

using namespace internal;

namespace {

Names role_names() {
  Names names = names_of(quantity_info, &QuantityInfo::name);
  names.resize(role_count);
  return names;
}

bool contains(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// Whether netCDF accepts the name of a variable; a sufficient check for this program.
bool is_variable_name(std::string_view name) {
  return !name.empty() && name.front() != ' ' && name.back() != ' ' &&
         std::none_of(name.begin(), name.end(), [](char letter) {
           const auto code = static_cast<unsigned char>(letter);
           return code < 0x20 || code == 0x7f || letter == '/';
         });
}

// Converts a parsed file to a model; entries without a meaning are refused with their position.
class Reader final : TomlReader {
 public:
  explicit Reader(std::string_view name) : TomlReader(name) {}

  ModelDefinition read(std::string_view text) {
    const toml::table root = parse(text);
    check_format(root);
    read_root(root);
    return std::move(file_);
  }

 private:
  std::string unknown(const Entry& entry) const override {
    return (entry.title.empty() && entry.node->is_table() ? "table " : "key ") + called(entry);
  }

  std::string variable_name(const Entry& entry) const {
    std::string name = text(entry, "the name of a variable in quotes");
    if (!is_variable_name(name)) {
      fail(entry, "{}: {} cannot be the name of a netCDF variable; give another", called(entry), quote(name));
    }
    return name;
  }

  Quantity role(const Entry& entry) const {
    const Quantity quantity = quantity_named(entry.key);
    if (quantity != Quantity::count && is_role(quantity)) return quantity;
    if (quantity != Quantity::count) {
      fail(entry.position, "{} is computed, not recorded, so it is not a role; remove it from {}",
           quote(entry.key), entry.title);
    }
    fail(entry.position, "there is no role {}; {}", quote(entry.key),
         suggestion_text(entry.key, role_names()));
  }

  void check_format(const toml::table& root) const {
    const std::optional<Entry> entry = entry_of(root, "format");
    const std::string format = entry ? entry->node->value_or(std::string()) : "";
    if (format != model_format && format.rfind("pcor-model/", 0) == 0)
      fail(*entry,
           "the file has the format {0}, but this program reads {1} only; use the pcor "
           "version that wrote it, or write format = \"{2}\"",
           quote(format), quote(model_format), model_format);
    require_format(root, "a model file", model_format);
  }

  // [variables] depends on the approach of [lams], most sections on [variables], and [covariance] on
  // [[effect]].
  void read_root(const toml::table& root) {
    each(root, "",
         {{"format", [](const Entry&) {}},
          {"name", [&](const Entry& entry) { file_.model.name = text(entry); }},
          {"aircraft", [&](const Entry& entry) { file_.model.aircraft = text(entry); }},
          {"roles", [&](const Entry& entry) { file_.roles_from = text(entry); }},
          {"lams", [&](const Entry& section) { read_lams(section); }},
          {"variables", [&](const Entry& section) { read_variables(section); }},
          {"units", [&](const Entry& section) { read_units(section); }},
          {"output", [&](const Entry& section) { read_output(section); }},
          {"temperature", [&](const Entry& section) { read_temperature(section); }},
          {"humidity", [&](const Entry& section) { read_humidity(section); }},
          {"radome", [&](const Entry& section) { read_radome(section); }},
          {"policy", [&](const Entry& section) { read_policy(section); }},
          {"domain", [&](const Entry& section) { read_domain(section); }},
          {"effect", [&](const Entry& section) { read_effects(section, name(), file_); }},
          {"law", [&](const Entry& section) { read_law(section); }},
          {"covariance", [&](const Entry& section) { read_covariance(section); }},
          {"uncertainty", [&](const Entry& section) { read_uncertainty(section); }},
          {"provenance",
           [&](const Entry& section) { file_.provenance = provenance(table(section), "[provenance]"); }}});
  }

  void read_variables(const Entry& section_entry) {
    for (const Entry& entry : entries_of(table(section_entry), "[variables]")) {
      const Quantity quantity = role(entry);
      file_.variables[quantity] = variable_name(entry);
      variable_positions_[quantity] = entry.position;
    }
    if (names_pressures()) require_pressures(section_entry.position);
    check_variables();
  }

  // A model without pressure variables uses the variables of the flight's aircraft.
  void require_pressures(Position position) const {
    for (const Quantity quantity : {Quantity::static_pressure, Quantity::dynamic_pressure}) {
      if (file_.variables.count(quantity) != 0) continue;
      const std::string_view name = info_of(quantity).name;
      fail(position, "the role '{}' has no variable; add {} = \"...\" to [variables]", name, name);
    }
  }

  bool names_pressures() const {
    return file_.variables.count(Quantity::static_pressure) != 0 ||
           file_.variables.count(Quantity::dynamic_pressure) != 0;
  }

  // Checks across variables. The position of an error is that of the later variable.
  void check_variables() const {
    if (names_pressures() &&
        file_.variables.at(Quantity::static_pressure) == file_.variables.at(Quantity::dynamic_pressure)) {
      fail(std::max(variable_positions_.at(Quantity::static_pressure),
                    variable_positions_.at(Quantity::dynamic_pressure)),
           fmt::format("'static_pressure' and 'dynamic_pressure' are both {}; give each its own variable",
                       quote(file_.variables.at(Quantity::static_pressure))));
    }
    give_one({humidity_roles.begin(), humidity_roles.end()}, "the humidity");
    if (file_.model.lams.approach != LamsApproach::with_temperature) {
      give_one({Quantity::recovery_temperature, Quantity::ambient_temperature},
               "the temperature, except with [lams] approach = 3, which uses the ambient temperature");
    }
  }

  // Error if more than one of `roles` has a variable.
  void give_one(const std::vector<Quantity>& roles, std::string_view what) const {
    std::vector<Quantity> given;
    for (const Quantity role : roles) {
      if (file_.variables.count(role) != 0) given.push_back(role);
    }
    if (given.size() < 2) return;
    std::stable_sort(given.begin(), given.end(), [this](Quantity a, Quantity b) {
      return variable_positions_.at(a) < variable_positions_.at(b);
    });
    fail(variable_positions_.at(given[1]), "the roles '{}' and '{}' both have a variable; give one for {}",
         info_of(given[0]).name, info_of(given[1]).name, what);
  }

  // Both `static_pressure = "mbar"` and `unit.static_pressure = "mbar"`.
  void read_units(const Entry& section_entry) {
    for (const Entry& entry : entries_of(table(section_entry), "[units]")) {
      if (entry.key != "unit") {
        read_unit(entry);
        continue;
      }
      for (const Entry& spelled : entries_of(table(entry, "unit.<role> = \"...\""), "[units]")) {
        read_unit(spelled);
      }
    }
  }

  void read_unit(const Entry& entry) {
    const Quantity quantity = role(entry);
    const std::string unit = text(entry, "a unit in quotes");
    const std::string requested(info_of(quantity).unit);
    require_variable(quantity, entry, "a unit");
    if (!is_known_unit(unit)) {
      fail(entry, "{}: unknown unit {}; give one that converts to {}", called(entry), quote(unit), requested);
    }
    if (!is_convertible(unit, requested)) {
      fail(entry, "{}: the unit {} does not convert to {}; give one that does", called(entry), quote(unit),
           requested);
    }
    if (!file_.units.emplace(quantity, unit).second) {
      fail(entry.position, "the unit of {} is given twice; remove one", quote(entry.key));
    }
  }

  // Without pressure variables the names follow from the flight's aircraft.
  void require_variable(Quantity role, const Entry& entry, std::string_view given) const {
    if (file_.variables.count(role) != 0 || !names_pressures()) return;
    fail(entry.position,
         "the role {} has {} but no variable; name its variable in [variables], or remove it from {}",
         quote(entry.key), given, entry.title);
  }

  void read_output(const Entry& section_entry) {
    const Names known = output_names();
    const std::vector<Entry> entries = entries_of(table(section_entry), "[output]");
    for (const Entry& entry : entries) {
      if (!contains(known, entry.key)) {
        fail(entry.position, "there is no output {}; {}", quote(entry.key),
             suggestion_text(entry.key, known));
      }
      file_.output[entry.key] = variable_name(entry);
    }
    for (const Entry& entry : entries) {
      for (const std::string& other : known) {
        if (other == entry.key || file_.output_name(other) != file_.output[entry.key]) continue;
        fail(entry, "{} and '{}' would both be written as {}; rename one of them", quote(entry.key), other,
             quote(file_.output[entry.key]));
      }
    }
  }

  void read_lams(const Entry& section_entry) {
    LamsMounting& lams = file_.model.lams;
    each(table(section_entry), "[lams]",
         {{"elevation", [&](const Entry& entry) { lams.elevation = number(entry); }},
          {"azimuth", [&](const Entry& entry) { lams.azimuth = number(entry); }},
          {"approach", [&](const Entry& entry) { lams.approach = approach(entry); }}});
  }

  LamsApproach approach(const Entry& entry) const {
    const std::int64_t which = whole_number(entry, "a whole number: 1, 2 or 3");
    if (which == 4) fail(entry, std::string(approach_4_refusal));
    if (which < 1 || which > 3) {
      fail(entry, "there is no approach {}; give 1, 2 or 3", which);
    }
    return static_cast<LamsApproach>(which);
  }

  void read_temperature(const Entry& section_entry) {
    each(table(section_entry), "[temperature]",
         {{"recovery_factor", [&](const Entry& entry) { read_recovery_factor(entry); }}});
  }

  void read_recovery_factor(const Entry& entry) {
    RecoveryFactor& recovery = file_.model.recovery;
    if (entry.node->is_string()) {
      const std::string name = text(entry);
      const PublishedRecoveryFactor* law = published_recovery_factor(name);
      if (law == nullptr) {
        const Names known = names_of(published_recovery_factors, &PublishedRecoveryFactor::name);
        fail(entry, "there is no published recovery factor {}; {}", quote(name),
             suggestion_text(name, known));
      }
      recovery = law->law;
      file_.recovery_factor_name = name;
      return;
    }
    const std::string requested = "a number, the name of a published law, or [c0, c1, c2, c3]";
    if (entry.node->is_array()) {
      const std::vector<double> coefficients = numbers(entry, requested);
      if (coefficients.size() != recovery.coefficients.size()) {
        fail(entry, "{} has {} numbers; give {}", called(entry), coefficients.size(), requested);
      }
      std::copy(coefficients.begin(), coefficients.end(), recovery.coefficients.begin());
    } else if (entry.node->is_number()) {
      recovery.coefficients = {number(entry), 0.0, 0.0, 0.0};
    } else {
      fail(entry, wrong_kind(entry, requested));
    }
    if (!recovery.is_possible()) {
      fail(entry, "recovery factor {} is out of range (0, {}]; correct it", recovery.coefficients[0],
           RecoveryFactor::maximum);
    }
  }

  void read_humidity(const Entry& section_entry) {
    each(table(section_entry), "[humidity]",
         {{"moist", [&](const Entry& entry) { file_.model.moist = boolean(entry); }}});
  }

  void read_radome(const Entry& section_entry) {
    each(table(section_entry), "[radome]",
         {{"attack", [&](const Entry& entry) { file_.model.attack_radome = radome(entry); }},
          {"sideslip", [&](const Entry& entry) { file_.model.sideslip_radome = radome(entry); }}});
  }

  RadomeCalibration radome(const Entry& entry) const {
    const std::string requested = "[offset, slope] or [offset, slope, slope for a unit of Mach number]";
    std::vector<double> values = numbers(entry, requested);
    if (values.size() != 2 && values.size() != 3) {
      fail(entry, "{} has {} numbers; give {}", called(entry), values.size(), requested);
    }
    values.resize(3);
    return {values[0], values[1], values[2]};
  }

  void read_policy(const Entry& section_entry) {
    Policy& policy = file_.model.policy;
    std::string given;
    const auto least = [&](const Entry& entry) {
      if (!given.empty())
        fail(entry.position, "{} and {} are the same limit; remove one", quote(given), quote(entry.key));
      given = entry.key;
      policy.min_dynamic_pressure = not_negative(entry);
    };
    each(table(section_entry), "[policy]",
         {{"taper_below", [&](const Entry& entry) { policy.taper_below = not_negative(entry); }},
          {"taper_power", [&](const Entry& entry) { policy.taper_power = not_negative(entry); }},
          {"minimum", [&](const Entry& entry) { policy.minimum = number(entry); }},
          {"least_dynamic_pressure", least},
          {"min_dynamic_pressure", least}});
  }

  void read_domain(const Entry& section_entry) {
    for (const Entry& entry : entries_of(table(section_entry), "[domain]")) {
      if (quantity_named(entry.key) == Quantity::count) {
        const Names known = names_of(quantity_info, &QuantityInfo::name);
        fail(entry.position, "there is no quantity {}; {}", quote(entry.key),
             suggestion_text(entry.key, known));
      }
      const auto [lower, upper] = range(entry);
      file_.model.domain.push_back({entry.key, lower, upper});
    }
  }

  void read_law(const Entry& section_entry) {
    LawInfo& law = file_.law;
    const toml::node* last = nullptr;
    each(table(section_entry), "[law]",
         {{"source", [&](const Entry& entry) { law.source = text(entry); }},
          {"valid_from", [&](const Entry& entry) { law.valid_from = date(entry); }},
          {"valid_to",
           [&](const Entry& entry) {
             law.valid_to = date(entry);
             last = entry.node;
           }},
          {"in_processing", [&](const Entry& entry) { law.operational = boolean(entry); }},
          {"rms_hpa", [&](const Entry& entry) { law.rms_hpa = not_negative(entry); }},
          {"note", [&](const Entry& entry) { law.note = text(entry); }}});
    if (last != nullptr && law.valid_to < law.valid_from) {
      fail(*last, "valid_to {} is before valid_from {}; change one of them", law.valid_to, law.valid_from);
    }
  }

  double not_negative(const Entry& entry) const {
    const double value = number(entry);
    if (value < 0.0) fail(entry, called(entry) + " is negative; give a number of 0 or above");
    return value;
  }

  void read_covariance(const Entry& section_entry) {
    std::optional<Entry> parameters, values, matrix;
    each(table(section_entry), "[covariance]",
         {{"parameters", [&](const Entry& entry) { parameters = entry; }},
          {"values", [&](const Entry& entry) { values = entry; }},
          {"matrix", [&](const Entry& entry) { matrix = entry; }}});
    if (!parameters || !matrix) {
      fail(section_entry.position,
           "[covariance] has no '{}'; give both parameters and matrix, or "
           "remove the table",
           parameters ? "matrix" : "parameters");
    }
    read_covariance_parameters(*parameters);
    if (values) check_values(*values);
    read_matrix(*matrix);
    check_standard_errors(*matrix);
  }

  // The covariance applies only to the values at which it was found.
  void check_values(const Entry& entry) const {
    const Names& names = file_.covariance.parameters;
    const std::string requested = fmt::format("{} numbers, one for each parameter", names.size());
    const std::vector<double> values = numbers(entry, requested);
    if (values.size() != names.size())
      fail(entry, "'values' has {} numbers; give {}", values.size(), requested);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const double value = parameter_value(file_.model, names[i]);
      if (std::abs(value - values[i]) <= 1e-9 * std::abs(value)) continue;
      fail(entry,
           "[covariance] does not match the coefficients: {} = {} in values, {} in its "
           "effect; refit the model or remove [covariance] and stderr",
           names[i], values[i], value);
    }
  }

  // The standard error in an effect must agree with the matrix within rounding.
  void check_standard_errors(const Entry& entry) const {
    const Names& names = file_.covariance.parameters;
    for (const auto& [name, effect, number] : named_parameters(file_.model)) {
      const auto found = std::find(names.begin(), names.end(), name);
      const std::optional<double> stated = file_.fit(effect, number).standard_error;
      if (found == names.end() || !stated) continue;
      const auto position = static_cast<std::size_t>(found - names.begin());
      const double here = std::sqrt(file_.covariance.matrix[position][position]);
      if (std::abs(here - *stated) <= 0.02 * std::max(here, *stated)) continue;
      fail(entry,
           "[covariance] does not match the effect: standard error of {} is {:.3g} in "
           "the matrix, {:.3g} in the effect; refit the model or remove one",
           name, here, *stated);
    }
  }

  void read_uncertainty(const Entry& section_entry) {
    StatedUncertainty& uncertainty = file_.uncertainty;
    for (const Entry& entry : entries_of(table(section_entry), "[uncertainty]")) {
      if (entry.key == "static_defect") {
        uncertainty.static_defect = not_negative(entry);
      } else if (entry.key == "static_defect_ratio") {
        uncertainty.static_defect_ratio = not_negative(entry);
      } else if (has_default_uncertainty(entry.key)) {
        uncertainty.sensors[std::string(entry.key)] = not_negative(entry);
      } else {
        uncertainty.roles[role_of_sample(entry)] = not_negative(entry);
      }
    }
  }

  Quantity role_of_sample(const Entry& entry) const {
    const Quantity quantity = quantity_named(entry.key);
    if (quantity == Quantity::count || !is_role(quantity)) {
      Names known = role_names();
      known.insert(known.end(), {"static_defect", "static_defect_ratio"});
      fail(entry.position, "there is no role {}; {}", quote(entry.key), suggestion_text(entry.key, known));
    }
    require_variable(quantity, entry, "an uncertainty");
    return quantity;
  }

  void read_covariance_parameters(const Entry& entry) {
    const Names known = names_of(named_parameters(file_.model), &NamedParameter::name);
    Names& names = file_.covariance.parameters;
    for (const auto& [node, name] : texts(entry, "the names of parameters, such as [\"static-qp.a2\"]")) {
      if (!contains(known, name) && !has_default_uncertainty(name)) {
        fail(*node, "the model has no parameter {}; {}", quote(name),
             known.empty() ? "remove [covariance]" : suggestion_text(name, known));
      }
      if (contains(names, name)) fail(*node, "{} is named twice; remove one", quote(name));
      names.push_back(name);
    }
  }

  void read_matrix(const Entry& entry) {
    const std::size_t size = file_.covariance.parameters.size();
    const std::string requested = fmt::format("{} rows of {} numbers, one for each parameter", size, size);
    std::vector<std::vector<double>>& matrix = file_.covariance.matrix;
    for (const toml::node& node : array(entry, requested)) {
      matrix.push_back(numbers({entry.key, entry.position, &node, entry.title}, requested));
      if (matrix.back().size() != size) {
        fail(node, "a row of the matrix has {} numbers; give {}", matrix.back().size(), requested);
      }
    }
    if (matrix.size() != size) {
      fail(entry, "the matrix has {} rows; give {}", matrix.size(), requested);
    }
    for (std::size_t i = 0; i < size; ++i) {
      if (matrix[i][i] < 0.0) fail(entry, "a variance of the matrix is negative; refit the model");
      for (std::size_t j = 0; j < i; ++j) {
        if (matrix[i][j] != matrix[j][i]) fail(entry, "the matrix is not symmetric; refit the model");
      }
    }
    std::vector<double> rows;
    for (const std::vector<double>& row : matrix) rows.insert(rows.end(), row.begin(), row.end());
    if (!is_covariance(rows, size)) {
      fail(entry, "the matrix is not positive semidefinite; refit the model");
    }
  }

  Provenance provenance(const toml::table& table, const std::string& title) const {
    Provenance values;
    for (const Entry& entry : entries_of(table, title)) {
      values.emplace_back(entry.key, provenance_value(*entry.node, title));
    }
    return values;
  }

  ProvenanceValue provenance_value(const toml::node& node, const std::string& title) const {
    if (const auto* value = node.as_string()) return value->get();
    if (const auto* value = node.as_integer()) return value->get();
    if (const auto* value = node.as_boolean()) return value->get();
    if (node.is_floating_point()) return finite(node, "a number of " + title);
    if (const auto* table = node.as_table()) return provenance(*table, title);
    if (const auto* list = node.as_array()) {
      ProvenanceList values;
      for (const toml::node& each_node : *list) values.push_back(provenance_value(each_node, title));
      return values;
    }
    std::ostringstream moment;
    moment.imbue(std::locale::classic());
    if (const auto* date = node.as_date()) moment << date->get();
    if (const auto* time = node.as_time()) moment << time->get();
    if (const auto* both = node.as_date_time()) moment << both->get();
    return moment.str();
  }

  ModelDefinition file_;
  std::map<Quantity, Position> variable_positions_;
};

}  // namespace

ModelDefinition parse_model(std::string_view text, std::string_view name) { return Reader(name).read(text); }

}  // namespace pcor
