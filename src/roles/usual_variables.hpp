#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/model/quantity.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "roles/variable_naming.hpp"

namespace pcor::internal {

/// Description of a series that flights usually record: a role, or one of the series that no model reads
/// ("other_altitude", "longitude", "ground_speed_east", "ground_speed_north"). nullptr for an unknown name.
const QuantityInfo* series_named(std::string_view name);

/// The names of all series.
std::vector<std::string> names_of_series();

/// The convention whose names complete a model on a flight: the convention of the model, otherwise of the
/// flight.
const VariableNaming& naming_of(const ModelDefinition& model, const Flight& flight);

/// Unit of the variable of a role in `model`, as the model states it, otherwise the data of the aircraft;
/// empty if neither does, so that the unit of the file holds.
std::string unit_of_role(const ModelDefinition& model, const VariableNaming& naming, Quantity role);

/// The names of the usual variables of a role in files of a convention. Empty for the roles that a model must
/// name itself, because several instruments measure them: pressures, temperatures, humidity, the laser, the
/// Mach number.
std::vector<std::string> usual_variables(const VariableNaming& naming, Quantity role);

/// The names of the usual variables of a role in files of all conventions.
std::vector<std::string> usual_variables(Quantity role);

/// All heights, GPS first, then inertial and pressure heights, which suffice to separate climbs from
/// descents.
std::vector<std::string> usual_heights(const VariableNaming& naming);

}  // namespace pcor::internal
