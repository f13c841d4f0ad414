#pragma once

#include <pcor/base/note.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>

namespace pcor {

/// Model with its undefined variables resolved by the names of the flight's aircraft:
/// `ModelDefinition::roles_from`, otherwise the aircraft detected from the flight's attributes and variables.
///
/// A model that names more than its pressures is complete: only units in the data of its aircraft
/// (`roles_from`) are added. Otherwise, pressures that are not named are the first measured pair with values,
/// or a pair corrected in the flight file, with a note; every further role is the first of its names with
/// values, with the unit and sign of the aircraft's data; the temperature is a recovery temperature if
/// recorded, with the recovery factor of its thermometer unless the model states one, otherwise the ambient
/// temperature. Adds the choices and caveats of these variables to `notes`, one sentence each.
/// @throws Error if the flight has no known pair of pressures, or matches several aircraft; the message
/// states the keys to add to the model.
ModelDefinition resolve_variables(const ModelDefinition& model, const Flight& flight, Notes& notes);

/// True if a model names only its two pressures, so that `resolve_variables` adds all other roles.
bool names_pressures_alone(const ModelDefinition& model);

}  // namespace pcor
