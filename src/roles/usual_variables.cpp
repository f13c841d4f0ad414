#include "roles/usual_variables.hpp"

#include <algorithm>
#include <array>

namespace pcor::internal {
namespace {

constexpr std::array<QuantityInfo, 4> extra_series{{
    {"other_altitude", "m", "altitude of an inertial system or of the pressure, up positive", Quantity::count,
     -5000.0, 100000.0},
    {"longitude", "deg", "longitude, east positive", Quantity::count, -720.0, 720.0},
    {"ground_speed_east", "m/s", "ground speed, east positive", Quantity::count, -1500.0, 1500.0},
    {"ground_speed_north", "m/s", "ground speed, north positive", Quantity::count, -1500.0, 1500.0},
}};

// Several instruments measure it, so that the choice is a part of the model.
bool is_chosen_by_model(Quantity role) {
  return role == Quantity::ambient_temperature || role == Quantity::vapor_pressure ||
         role == Quantity::dew_point || role == Quantity::lams_airspeed;
}

void append(std::vector<std::string>& names, const std::vector<std::string>& more) {
  for (const std::string& name : more) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
}

}  // namespace

const QuantityInfo* series_named(std::string_view name) {
  for (const QuantityInfo& info : extra_series) {
    if (info.name == name) return &info;
  }
  const Quantity role = quantity_named(name);
  return role == Quantity::count || !is_role(role) ? nullptr : &info_of(role);
}

std::vector<std::string> names_of_series() {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < role_count; ++i) names.emplace_back(info_of(static_cast<Quantity>(i)).name);
  for (const QuantityInfo& info : extra_series) names.emplace_back(info.name);
  return names;
}

const VariableNaming& naming_of(const ModelDefinition& model, const Flight& flight) {
  return model.roles_from.empty() ? naming_of(flight) : naming_by_name(model.roles_from);
}

std::vector<std::string> usual_variables(const VariableNaming& naming, Quantity role) {
  return is_chosen_by_model(role) ? std::vector<std::string>() : naming.names_of(info_of(role).name);
}

std::vector<std::string> usual_variables(Quantity role) {
  std::vector<std::string> names;
  for (const VariableNaming& naming : known_namings()) append(names, usual_variables(naming, role));
  return names;
}

std::vector<std::string> usual_heights(const VariableNaming& naming) {
  std::vector<std::string> names = usual_variables(naming, Quantity::altitude);
  append(names, naming.names_of("other_altitude"));
  return names;
}

std::string unit_of_role(const ModelDefinition& model, const VariableNaming& naming, Quantity role) {
  const auto stated = model.units.find(role);
  return stated == model.units.end() ? naming.unit_of(model.variables.at(role)) : stated->second;
}

}  // namespace pcor::internal
