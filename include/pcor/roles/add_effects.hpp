#pragma once

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace pcor {

/// Model with additional `effects`, with neutral parameters unless given. Roles that they need and the model
/// does not name get the usual variable of NCAR's files. `variables` are those of a flight, to choose among
/// usual names; empty if no flight is available. The provenance lists the effects (`added_effects`).
/// @param flight in which a variable without a usual name is chosen by its name, unit and values; may be null
/// @throws Error if an effect is already in the model or unknown, or needs a role without such a variable.
ModelDefinition add_effects(const ModelDefinition& model, const std::vector<ModelEffect>& effects,
                            const std::vector<std::string>& variables = {}, const Flight* flight = nullptr);

/// Ids of the effects that `add_effects` added to a published law, in the model or in the models before it: a
/// diagnosis treats the shape of those of the flow as uncertain.
std::vector<std::string> added_effects(const ModelDefinition& model);

/// One of `surface_info` with its knots over what some flights flew: from the first to the 99th percentile of
/// both axes at Mach numbers above 0.18, which is 60 m/s. Coefficients are zero.
/// @param flight gives each of the flights, one after another
/// @param splines on each axis
/// @throws Error if there is no such surface, a flight does not record an axis, or they flew no envelope.
ModelEffect surface_over(std::size_t flights, const std::function<const Flight&(std::size_t)>& flight,
                         const ModelDefinition& model, std::string_view id, std::size_t splines = 6);

}  // namespace pcor
