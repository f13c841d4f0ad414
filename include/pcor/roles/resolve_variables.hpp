#pragma once

#include <string>
#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>

namespace pcor {

/// The model with the variables that it leaves open, by the names that the flight's aircraft has for them:
/// those of `ModelDefinition::roles_from`, else of the aircraft that the flight's attributes and variables
/// tell.
///
/// A model that names more than its pressures is complete: it gets the units alone that the data of its own
/// aircraft (`roles_from`) state. Else its pressures, where it names none, are the first pair as measured
/// that has values, or one that the flight's own processing corrected, which is noted; every further role is
/// the first of its names that has values, in the unit, and with the sign, that the aircraft's data state;
/// the temperature is a recovery temperature where one is recorded, with the recovery factor of its
/// thermometer unless the model states one, else that of the air. Adds to `notes` what was chosen, and what a
/// user of these variables should know, a sentence each.
/// @throws Error if the flight has no pair of pressures that is known, or is like the files of several
/// aircraft; the message says what to write into the model.
ModelDefinition resolve_variables(const ModelDefinition& model, const Flight& flight,
                                  std::vector<std::string>& notes);

/// Whether a model names its two pressures and nothing else, so that `resolve_variables` gives it all other
/// roles.
bool names_pressures_alone(const ModelDefinition& model);

}  // namespace pcor
