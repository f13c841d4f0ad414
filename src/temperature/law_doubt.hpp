#pragma once

#include <optional>

#include <pcor/model_io/model_definition.hpp>
#include "campaign/flight_air.hpp"

namespace pcor::internal {

/// Variance of delta-p stated by a model, hPa2, averaged over the samples in the air: from the covariance of
/// its coefficients, and its remaining error. nullopt if the model states neither.
std::optional<double> stated_law_variance(const ModelDefinition& model, const FlightAir& air);

}  // namespace pcor::internal
