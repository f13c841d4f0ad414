#include <pcor/roles/resolve_variables.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include <pcor/base/error.hpp>
#include "model_io/model_names.hpp"
#include "roles/recorded_series.hpp"
#include "roles/usual_variables.hpp"

namespace pcor {

using namespace internal;

namespace {

/// One flight and the model that it completes.
class Completion {
 public:
  Completion(ModelDefinition model, const Flight& flight, const VariableNaming& naming)
      : file_(std::move(model)), flight_(flight), naming_(naming) {}

  ModelDefinition complete(Notes& notes) {
    take_pressures();
    take_temperature();
    if (std::none_of(humidity_roles.begin(), humidity_roles.end(),
                     [this](Quantity role) { return has(role); }) &&
        std::none_of(humidity_roles.begin(), humidity_roles.end(),
                     [this](Quantity role) { return take(role); }) &&
        file_.model.moist) {
      file_.model.moist = false;
      caveats_.emplace_back("no humidity is recorded: the air is assumed dry");
    }
    for (std::size_t i = 0; i < role_count; ++i) {
      const auto role = static_cast<Quantity>(i);
      if (!is_chosen_above(role) && !has(role)) take(role);
    }
    keep_known(file_.units);
    keep_known(file_.uncertainty.roles);
    notes.push_back(fmt::format("roles by {}: {}", naming_.name, fmt::join(taken_, ", ")));
    for (std::string& caveat : caveats_) notes.push_back(std::move(caveat));
    return std::move(file_);
  }

 private:
  /// Taken already, or found by the model itself.
  bool is_chosen_above(Quantity role) const {
    if (role == Quantity::attack) return file_.model.attack_radome.is_calibrated();
    if (role == Quantity::sideslip) return file_.model.sideslip_radome.is_calibrated();
    if (role == Quantity::ambient_temperature)
      return file_.model.lams.approach != LamsApproach::with_temperature;
    return is_humidity(role);
  }

  bool has(Quantity role) const { return file_.variables.count(role) != 0; }

  /// Removes entries of roles without a variable.
  template <class Value>
  void keep_known(std::map<Quantity, Value>& entries) const {
    for (auto entry = entries.begin(); entry != entries.end();)
      entry = has(entry->first) ? std::next(entry) : entries.erase(entry);
  }

  void set(Quantity role, const std::string& variable) {
    file_.variables[role] = variable;
    if (std::string unit = naming_.unit_of(variable); !unit.empty())
      file_.units.emplace(role, std::move(unit));
    taken_.push_back(fmt::format("{} = {}", info_of(role).name, variable));
    const auto caveat = naming_.caveats.find(variable);
    if (caveat != naming_.caveats.end()) caveats_.push_back(fmt::format("{}: {}", variable, caveat->second));
  }

  bool take(Quantity role) {
    const std::string variable = first_with_values(flight_, naming_, info_of(role).name);
    if (!variable.empty()) set(role, variable);
    return !variable.empty();
  }

  bool take_pair(const std::vector<PressurePair>& pairs) {
    const PressurePair* const pair = first_with_values(flight_, naming_, pairs);
    if (pair == nullptr) return false;
    set(Quantity::static_pressure, pair->static_pressure);
    set(Quantity::dynamic_pressure, pair->dynamic_pressure);
    return true;
  }

  void take_pressures() {
    if (has(Quantity::static_pressure) && has(Quantity::dynamic_pressure)) return;
    if (take_pair(naming_.measured)) return;
    if (take_pair(naming_.processed)) {
      caveats_.push_back(fmt::format(
          "{} and {} are already corrected by the archive: a fit finds the remaining error",
          file_.variables.at(Quantity::static_pressure), file_.variables.at(Quantity::dynamic_pressure)));
      return;
    }
    std::vector<std::string> searched_names;
    for (const PressurePair& pair : naming_.measured) searched_names.push_back(pair.name());
    throw Error(
        Error::Code::variable,
        fmt::format("{}: no pair of static and dynamic pressure with the names of {} was found ({}); set "
                    "static_pressure and dynamic_pressure in the [variables] of the model, or another "
                    "aircraft with roles = \"...\"; 'pcor inspect' lists the variables of the flight",
                    flight_.path().string(), naming_.title, fmt::join(searched_names, ", ")));
  }

  void take_temperature() {
    if (has(Quantity::recovery_temperature) || has(Quantity::ambient_temperature)) return;
    const Thermometer* const thermometer = first_with_values(flight_, naming_, naming_.thermometers);
    if (thermometer == nullptr) {
      take(Quantity::ambient_temperature);
      return;
    }
    set(Quantity::recovery_temperature, thermometer->variable);
    const bool states_one = !file_.recovery_factor_name.empty() ||
                            file_.model.recovery.coefficients != Model().recovery.coefficients;
    if (states_one) return;
    file_.model.recovery = published_recovery_factor(thermometer->recovery)->law;
    file_.recovery_factor_name = thermometer->recovery;
  }

  ModelDefinition file_;
  const Flight& flight_;
  const VariableNaming& naming_;
  std::vector<std::string> taken_;
  std::vector<std::string> caveats_;
};

/// With the units that the aircraft's data state of the variables that the model names.
ModelDefinition with_units(ModelDefinition model, const VariableNaming& naming) {
  for (const auto& [role, variable] : model.variables) {
    if (std::string unit = naming.unit_of(variable); !unit.empty())
      model.units.emplace(role, std::move(unit));
  }
  return model;
}

}  // namespace

bool names_pressures_alone(const ModelDefinition& model) {
  return model.variables.size() == 2 && model.variables.count(Quantity::static_pressure) != 0 &&
         model.variables.count(Quantity::dynamic_pressure) != 0;
}

ModelDefinition resolve_variables(const ModelDefinition& model, const Flight& flight, Notes& notes) {
  if (!names_pressures_alone(model) && (model.variables.count(Quantity::static_pressure) != 0 ||
                                        model.variables.count(Quantity::dynamic_pressure) != 0)) {
    return model.roles_from.empty() ? model : with_units(model, naming_by_name(model.roles_from));
  }
  if (model.roles_from.empty()) {
    const std::vector<const VariableNaming*> like = matching_namings(flight);
    if (like.size() > 1) {
      std::vector<std::string> names;
      for (const VariableNaming* naming : like) names.push_back(naming->name);
      throw Error(
          Error::Code::variable,
          fmt::format("{}: the file resembles the files of {}; choose one in the model, roles = \"{}\"",
                      flight.path().string(), fmt::join(names, " and of "), names.front()));
    }
  }
  return Completion(model, flight, naming_of(model, flight)).complete(notes);
}

}  // namespace pcor
