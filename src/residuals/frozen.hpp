#pragma once

#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// Finds the sensors that freeze in the air among those that a part of the samples, model or reference,
/// reads, and notes them. @param min_airspeed m/s; slower samples do not count
void mark_frozen(FlightSamples& samples, ModelSamples FlightSamples::*part, double min_airspeed);

}  // namespace pcor::internal
