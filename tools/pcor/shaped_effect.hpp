#pragma once

#include <string>

#include <pcor/model/model.hpp>

namespace pcor::tool {

/// An effect of the catalogue as a command takes it: its id and, behind a colon, what shapes it otherwise
/// than usual, with the powers of its scaling: "static-transonic:onset=0.8",
/// "static-beta-odd:static_pressure=-1,dynamic_pressure=1".
std::string argument_of(const ModelEffect& effect);

/// The effect that such an argument names, neutral but for its shape. @throws Error if there is none.
ModelEffect shaped_effect(const std::string& argument);

}  // namespace pcor::tool
