#pragma once

#include <vector>

#include <pcor/fit/refit.hpp>
#include "fit/surface_roughness.hpp"

namespace pcor::internal {

/// The model with the coefficients that `refit` finds, without their errors and without any statement on the
/// flights: for a model of which only the predictions are compared. Arguments and errors as `refit`.
/// @param surfaces start of the priors of the model's surfaces, as found on similar flights; empty: unknown.
/// On return those that were found
ModelDefinition fitted_coefficients(const FlightSet& flights, const ModelDefinition& model,
                                    const References& references, const RefitOptions& options,
                                    std::vector<SurfaceRoughness>& surfaces);

}  // namespace pcor::internal
