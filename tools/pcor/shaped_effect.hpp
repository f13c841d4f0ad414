#pragma once

#include <optional>
#include <string>

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>

namespace pcor::tool {

/// Effect of the catalogue in the syntax of a command: its id and, after a colon, shape parameters that
/// differ from the default, with the powers of its scaling: "static-transonic:onset=0.8",
/// "static-beta-odd:static_pressure=-1,dynamic_pressure=1".
std::string argument_of(const ModelEffect& effect);

/// Effect named by such an argument, neutral except for its shape. @throws Error if there is no such effect.
ModelEffect shaped_effect(const std::string& argument);

/// The surface named by an argument such as "static-surface:splines=8", over the range of a flight; empty for
/// other effects. @param flight may be null @throws Error if the flight is missing or does not determine the
/// axes.
std::optional<ModelEffect> surface_argument(const std::string& argument, const Flight* flight,
                                            const ModelDefinition& model);

}  // namespace pcor::tool
