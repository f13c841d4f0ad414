#pragma once

#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// Finds and marks sensors that freeze in the air, among the inputs of a part of the samples, model or
/// reference, and adds notes. @param min_airspeed m/s; slower samples are not used
void mark_frozen(FlightSamples& samples, ModelSamples FlightSamples::*part, double min_airspeed);

}  // namespace pcor::internal
