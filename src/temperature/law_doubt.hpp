#pragma once

#include <optional>

#include <pcor/model_io/model_definition.hpp>
#include "campaign/flight_air.hpp"

namespace pcor::internal {

/// The variance of delta-p that a model states, hPa2, the mean over the samples in the air: of the
/// coefficients of its law by their covariance, and of what the law leaves. Nothing where the model states
/// neither.
std::optional<double> stated_law_variance(const ModelDefinition& model, const FlightAir& air);

}  // namespace pcor::internal
