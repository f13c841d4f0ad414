#include "process/copied_variables.hpp"

#include <algorithm>

#include "model_io/archived_model.hpp"
#include "roles/usual_variables.hpp"

namespace pcor::internal {
namespace {

/// First of several names that is a time series of the flight; empty if there is no such series.
std::string first_series(const Flight& flight, const Names& names) {
  const auto found = std::find_if(names.begin(), names.end(), [&flight](const std::string& name) {
    return flight.has(name) && flight.variable(name).is_series;
  });
  return found == names.end() ? std::string() : *found;
}

/// First time series with the given CF standard name; empty if there is no such series.
std::string series_that_is(const Flight& flight, const std::string& standard_name) {
  for (const std::string& name : flight.variables()) {
    const VariableInfo& info = flight.variable(name);
    if (info.is_series && info.attribute("standard_name") == standard_name) return name;
  }
  return {};
}

}  // namespace

void name_coordinates(const Flight& flight, const ModelDefinition& model, FileDescription& description) {
  const auto coordinate = [&flight](const char* attribute, const std::string& given, Names usual,
                                    const char* standard_name) {
    usual.insert(usual.begin(), {flight.attribute(attribute), given});
    const std::string named = first_series(flight, usual);
    return named.empty() ? series_that_is(flight, standard_name) : named;
  };
  const VariableNaming& naming = naming_of(model, flight);
  description.latitude = coordinate("latitude_coordinate", model.variable_of(Quantity::latitude),
                                    usual_variables(naming, Quantity::latitude), "latitude");
  description.longitude = coordinate("longitude_coordinate", "", naming.names_of("longitude"), "longitude");
  description.altitude = coordinate("zaxis_coordinate", model.variable_of(Quantity::altitude),
                                    usual_heights(naming), "altitude");
  if (description.altitude.rfind("PALT", 0) == 0) description.altitude_standard_name = "barometric_altitude";
}

std::string series_name(const Flight& flight, const ModelDefinition& model, Quantity role) {
  const VariableNaming& naming = naming_of(model, flight);
  Names names = role == Quantity::altitude ? usual_heights(naming) : usual_variables(naming, role);
  names.insert(names.begin(), model.variable_of(role));
  return first_series(flight, names);
}

Names motion_variables(const Flight& flight, const ModelDefinition& model) {
  Names flown;
  for (const Quantity role : motion_quantities) flown.push_back(series_name(flight, model, role));
  const VariableNaming& naming = naming_of(model, flight);
  for (const char* velocity : {"ground_speed_east", "ground_speed_north"})
    flown.push_back(first_series(flight, naming.names_of(velocity)));
  return flown;
}

}  // namespace pcor::internal
