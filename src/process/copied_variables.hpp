#pragma once

#include <pcor/flight/flight_writer.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "base/quoting.hpp"

namespace pcor::internal {

/// Sets the coordinate variables of the flight: those named by the flight or the model, otherwise the usual
/// ones. Empty if absent.
void name_coordinates(const Flight& flight, const ModelDefinition& model, FileDescription& description);

/// Name of the time series of a role: the model's variable, otherwise the first usual one; empty if absent.
std::string series_name(const Flight& flight, const ModelDefinition& model, Quantity role);

/// Available inputs of a temperature fit other than those of the model: height, position and motion.
Names motion_variables(const Flight& flight, const ModelDefinition& model);

}  // namespace pcor::internal
