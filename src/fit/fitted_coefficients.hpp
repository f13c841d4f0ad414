#pragma once

#include <vector>

#include <pcor/fit/refit.hpp>
#include "fit/surface_roughness.hpp"

namespace pcor::internal {

/// The model with the coefficients that `refit` finds, without their errors and without any statement on the
/// flights: for a model of which only the predictions are compared. Arguments and errors as `refit`.
/// @param surfaces in: initial priors of the surfaces, from a fit of the same model and references; empty:
/// the default sizes. Out: the priors of this fit; unchanged if a reference is by GPS
ModelDefinition fitted_coefficients(const FlightSet& flights, const ModelDefinition& model,
                                    const References& references, const RefitOptions& options,
                                    std::vector<SurfaceRoughness>& surfaces);

}  // namespace pcor::internal
