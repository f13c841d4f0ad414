#pragma once

#include <optional>
#include <string>

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>

namespace pcor::tool {

/// An effect of the catalogue as a command takes it: its id and, behind a colon, what shapes it otherwise
/// than usual, with the powers of its scaling: "static-transonic:onset=0.8",
/// "static-beta-odd:static_pressure=-1,dynamic_pressure=1".
std::string argument_of(const ModelEffect& effect);

/// The effect that such an argument names, neutral but for its shape. @throws Error if there is none.
ModelEffect shaped_effect(const std::string& argument);

/// The surface that such an argument names, as "static-surface:splines=8", over what a flight flew; nothing
/// where it names none. @param flight may be null @throws Error if the flight is missing or does not tell the
/// axes.
std::optional<ModelEffect> surface_argument(const std::string& argument, const Flight* flight,
                                            const ModelDefinition& model);

}  // namespace pcor::tool
