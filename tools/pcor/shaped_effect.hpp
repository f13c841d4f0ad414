#pragma once

#include <string>

#include <pcor/model/model.hpp>

namespace pcor::tool {

/// Effect of the catalogue in the syntax of a command: its id and, after a colon, shape parameters that
/// differ from the default, with the powers of its scaling: "static-transonic:onset=0.8",
/// "static-beta-odd:static_pressure=-1,dynamic_pressure=1".
std::string argument_of(const ModelEffect& effect);

/// Effect named by such an argument, neutral except for its shape. @throws Error if there is no such effect.
ModelEffect shaped_effect(const std::string& argument);

}  // namespace pcor::tool
