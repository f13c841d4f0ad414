#include "roles/model_inputs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include <pcor/base/error.hpp>
#include <pcor/base/suggest.hpp>
#include <pcor/base/utc.hpp>
#include "base/quoting.hpp"
#include "flight/called_corrected.hpp"
#include "flight/registration.hpp"
#include "model_io/model_names.hpp"
#include "roles/plausible_pressure.hpp"
#include "roles/recorded_series.hpp"
#include "roles/role_evidence.hpp"
#include "roles/usual_variables.hpp"

namespace pcor::internal {
namespace {

bool is_same(double a, double b) {
  constexpr double rounding = 1e-9;
  return std::abs(a - b) <= rounding * std::abs(a);
}

void warn_once(Notes& notes, std::string text) {
  Note note = warning_note(std::move(text));
  if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(std::move(note));
}

/// The unit in the model replaces the unit in the file. Either may be wrong. A sign that the aircraft's data
/// state is known.
void note_other_unit(const Flight& flight, const ModelDefinition& file, const VariableNaming& naming,
                     Quantity role, Notes& notes) {
  const std::string& name = file.variables.at(role);
  const std::string stated = unit_of_role(file, naming, role);
  if (stated.empty() || !flight.has(name)) return;
  const std::string& recorded = flight.variable(name).units;
  const std::string unit(info_of(role).unit);
  if (!is_known_unit(recorded) || !is_convertible(stated, unit)) return;
  if (is_convertible(recorded, unit)) {
    const UnitConversion a = UnitConversion::between(recorded, unit, {});
    const UnitConversion b = UnitConversion::between(stated, unit, {});
    const bool same_scale =
        is_same(a.scale(), b.scale()) || (stated == naming.unit_of(name) && is_same(a.scale(), -b.scale()));
    if (same_scale && is_same(a.offset(), b.offset())) return;
  }
  warn_once(notes, fmt::format("{} is read in {}, not in {} of the file: [units] of the model or the data of "
                               "the aircraft state this unit",
                               name, quote(stated), quote(recorded)));
}

bool has_any(const std::vector<std::string>& words, std::initializer_list<std::string_view> any) {
  return std::find_first_of(words.begin(), words.end(), any.begin(), any.end()) != words.end();
}

/// Warns if the file calls the recovery temperature of a model the temperature of the air.
void note_ambient(const Flight& flight, const ModelDefinition& file, Notes& notes) {
  const std::string name = file.variable_of(Quantity::recovery_temperature);
  if (!flight.has(name)) return;
  const VariableInfo& variable = flight.variable(name);
  const std::vector<std::string> words = plain_words(variable.long_name);
  const bool is_ambient = has_any(words, {"ambient", "static", "outside"}) ||
                          variable.attribute("standard_name") == "air_temperature";
  if (!is_ambient || has_any(words, {"recovery", "total", "indicated"})) return;
  warn_once(notes,
            fmt::format("name {} as ambient_temperature in [variables], not as recovery_temperature; the "
                        "file describes it as '{}'",
                        name, variable.long_name.empty() ? "air_temperature" : variable.long_name));
}

/// Whether the model has a law of delta-p for other pressures: it was neither fitted to those of the model,
/// nor is it the first fit of a model without law.
bool has_foreign_law(const ModelDefinition& file) {
  const std::vector<ModelEffect>& effects = file.model.effects;
  const bool has_law = std::any_of(effects.begin(), effects.end(), [](const ModelEffect& effect) {
    return location_of(effect) == EffectLocation::static_defect && !is_neutral(effect);
  });
  if (const auto* const fitted = find_entry<ProvenanceList>(file.provenance, "pressures"))
    return has_law && *fitted != fitted_pressures(file);
  std::string source = file.law.source;
  if (const auto* const before = find_entry<ProvenanceList>(file.provenance, "before");
      before != nullptr && !before->empty()) {
    const auto* const first = std::get_if<Provenance>(&before->front());
    const auto* const text = first == nullptr ? nullptr : find_entry<std::string>(*first, "source");
    if (text != nullptr) source = *text;
  }
  return has_law && source != source_without_law;
}

/// Warns if the file calls a pressure of the model corrected, or that of the cabin.
void note_wrong_pressure(const Flight& flight, const ModelDefinition& file, Notes& notes) {
  for (const Quantity role : {Quantity::static_pressure, Quantity::dynamic_pressure}) {
    const std::string name = file.variable_of(role);
    if (!flight.has(name)) continue;
    const std::string& described = flight.variable(name).long_name;
    const bool is_of_cabin = has_any(plain_words(described), {"cabin"});
    if (!is_of_cabin && !(is_called_corrected(described) && has_foreign_law(file))) continue;
    warn_once(notes,
              fmt::format("name another variable than {} as {} in [variables]: the file describes it as "
                          "'{}'{}",
                          name, info_of(role).name, described,
                          is_of_cabin ? "" : ", so the model would correct it a second time"));
  }
}

/// Whether model and flight state different aircraft.
bool are_of_two_aircraft(const ModelDefinition& file, const Flight& flight) {
  return !file.model.aircraft.empty() && !flight.aircraft().empty() && !is_of_aircraft(file, flight);
}

}  // namespace

ProvenanceList fitted_pressures(const ModelDefinition& file) {
  return {file.variable_of(Quantity::static_pressure), file.variable_of(Quantity::dynamic_pressure)};
}

void note_other_units(const Flight& flight, const ModelDefinition& file, Notes& notes) {
  const VariableNaming& naming = naming_of(file, flight);
  for (const auto& entry : file.variables) note_other_unit(flight, file, naming, entry.first, notes);
}

std::vector<Quantity> roles_of(const ModelDefinition& file, bool with_laser) {
  std::vector<Quantity> roles = file.roles();
  if (!with_laser) roles.erase(std::remove(roles.begin(), roles.end(), Quantity::lams_airspeed), roles.end());
  return roles;
}

Chain chain_of(const Model& model, const std::vector<Quantity>& roles) {
  BindingError why;
  std::optional<Chain> chain = Chain::build(model, roles, &why);
  if (!chain) throw Error(Error::Code::model, fmt::format("model '{}': {}", model.name, why.message()));
  return std::move(*chain);
}

std::vector<ModelInput> model_inputs(const Flight& flight, const ModelDefinition& file, const Chain& chain,
                                     const std::vector<Quantity>& roles, Notes& notes) {
  require_possible_pressure(flight, file, notes);
  note_ambient(flight, file, notes);
  note_wrong_pressure(flight, file, notes);
  const VariableNaming& naming = naming_of(file, flight);
  const auto conversion_of = [&](Quantity role) {
    const QuantityInfo& info = info_of(role);
    const std::string& variable = file.variables.at(role);
    const std::string unit = unit_of_role(file, naming, role);
    if (!flight.has(variable) && are_of_two_aircraft(file, flight)) {
      throw Error(
          Error::Code::variable,
          fmt::format("{}: the model '{}' is of the aircraft '{}', the flight of '{}', which has no {}; "
                      "give a model of that aircraft: pcor inspect lists them",
                      flight.path().string(), file.model.name, file.model.aircraft, flight.aircraft(),
                      variable));
    }
    note_other_unit(flight, file, naming, role, notes);
    return within_plausible_range(
        flight.conversion(variable, std::string(info.unit), std::string(info.name), unit), info);
  };
  std::vector<ModelInput> inputs;
  for (const Quantity role : roles) {
    if (!chain.needs(role) && !is_always_read(role)) continue;
    inputs.push_back({file.variables.at(role), role, conversion_of(role)});
  }
  // A formula that names the variable of a role means that role; other variables it takes as the file has
  // them.
  const std::vector<std::string>& extras = chain.extra_names();
  for (std::size_t i = 0; i < extras.size(); ++i) {
    const std::string& name = extras[i];
    if (const Quantity role = role_of_variable(file, name); role != Quantity::count) {
      inputs.push_back({name, extra_quantity(i), conversion_of(role)});
      continue;
    }
    if (!flight.has(name)) {
      const std::string meant = did_you_mean(name, flight.variables());
      throw Error(Error::Code::variable,
                  fmt::format("{}: {} in a formula of the model is neither a variable of this file nor a "
                              "quantity{}",
                              flight.path().string(), name, meant.empty() ? "" : "; " + meant));
    }
    const std::string unit = flight.variable(name).units;
    notes.push_back(fmt::format("a formula of the model reads {} in the unit of the file{}", name,
                                unit.empty() ? std::string(" (not stated)") : ", " + unit));
    inputs.push_back({name, extra_quantity(i), UnitConversion()});
  }
  for (const ModelInput& input : inputs) flight.require_values(input.variable);
  const auto note = [&](const char* text, const auto& concerns) {
    std::vector<std::string> names;
    for (const ModelInput& input : inputs) {
      if (concerns(flight.variable(input.variable))) names.push_back(input.variable);
    }
    if (!names.empty()) notes.push_back(fmt::format("{}: {}", text, fmt::join(names, ", ")));
  };
  note("samples flagged as bad or missing in the file are treated as missing",
       [](const VariableInfo& variable) { return !variable.flags.empty(); });
  note("the valid ranges of these variables in the file are not numbers and were ignored",
       [](const VariableInfo& variable) { return !variable.ignored_range.empty(); });
  return inputs;
}

void note_excluded(const ModelInput& input, const RejectedCounts& excluded, Notes& notes) {
  const auto note = [&](std::size_t samples, const std::string& where) {
    if (samples == 0) return;
    notes.push_back(fmt::format("{} {}, and {} treated as missing",
                                samples == 1 ? fmt::format("a sample of {} lies", input.variable)
                                             : fmt::format("{} samples of {} lie", samples, input.variable),
                                where, samples == 1 ? "is" : "are"));
  };
  const std::string unit = is_role(input.quantity) ? fmt::format(" {}", info_of(input.quantity).unit) : "";
  note(excluded.impossible, fmt::format("outside {:g} to {:g}{}, which is impossible",
                                        input.conversion.minimum(), input.conversion.maximum(), unit));
  note(excluded.invalid, "outside the range that the file states as valid");
  note(excluded.enormous, "above 1e30, which marks missing values");
}

Notes notes_on_law(const Flight& flight, const ModelDefinition& file) {
  Notes notes;
  const std::string day = utc_text(flight.time().first, "%Y-%m-%d");
  const LawInfo& law = file.law;
  if (!law.is_valid_on(day)) {
    const bool early = day < law.valid_from;
    notes.push_back(warning_note(
        fmt::format("the law is valid {} {}, the flight is of {}; choose a model of that date in data/models",
                    early ? "from" : "until", early ? law.valid_from : law.valid_to, day)));
  }
  if (are_of_two_aircraft(file, flight)) {
    notes.push_back(
        warning_note(fmt::format("use a model of this aircraft: the model is for '{}', the flight is of '{}'",
                                 file.model.aircraft, flight.aircraft())));
  }
  return notes;
}

bool is_of_aircraft(const ModelDefinition& file, const Flight& flight) {
  const std::string& model = file.model.aircraft;
  const std::string aircraft = flight.aircraft();
  if (model.empty() || aircraft.empty()) return false;
  const std::string registration = registration_in(aircraft);
  const std::string of_model = registration_in(model);
  if (!registration.empty() || !of_model.empty()) return registration == of_model;
  // Registrations of other countries: one text is the last word of the other.
  const auto ends_with = [](const std::string& text, const std::string& word) {
    return text == word ||
           (text.size() > word.size() && text.substr(text.size() - word.size() - 1) == " " + word);
  };
  return ends_with(model, aircraft) || ends_with(aircraft, model);
}

}  // namespace pcor::internal
