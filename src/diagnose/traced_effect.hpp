#pragma once

#include <string>

#include <pcor/diagnose/diagnose.hpp>

namespace pcor::internal {

/// Name of an effect that describes a traced variable.
std::string id_of_trace(const std::string& variable);

/// Formula of a traced variable as an effect with the estimated slope.
/// @param flights description of the flights in which it was traced
ModelEffect effect_of(const EmpiricalPredictor& variable, const std::string& flights);

}  // namespace pcor::internal
