#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/model/quantity.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "roles/aircraft_family.hpp"

namespace pcor::internal {

/// The facts of a series that flights usually record: of a role, or of one of those that no model reads,
/// "other_altitude", "longitude", "ground_speed_east" and "ground_speed_north". Null where there is none.
const QuantityInfo* series_named(std::string_view name);

/// The names of all series.
std::vector<std::string> names_of_series();

/// The family whose names complete those of a model on a flight: the model's own, else that of the flight.
const VariableNaming& family_of(const ModelDefinition& model, const Flight& flight);

/// The names of the usual variables of a role in files of a family. Empty for the roles that a model must
/// name itself, because several instruments measure them: pressures, temperatures, humidity, the laser, the
/// Mach number.
std::vector<std::string> usual_variables(const VariableNaming& family, Quantity role);

/// The same in files of all families.
std::vector<std::string> usual_variables(Quantity role);

/// All heights, that of GPS before those of inertial systems and of the pressure, which do to tell a climb
/// from a descent.
std::vector<std::string> usual_heights(const VariableNaming& family);

}  // namespace pcor::internal
