#pragma once

#include <string>

#include <pcor/diagnose/diagnose.hpp>

namespace pcor::internal {

/// What an effect that describes a traced variable is called.
std::string id_of_trace(const std::string& variable);

/// The formula of a traced variable as an effect with the slope that was found.
/// @param flights in which it was traced, in words
ModelEffect effect_of(const EmpiricalPredictor& variable, const std::string& flights);

}  // namespace pcor::internal
