#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <pcor/fit/refit.hpp>
#include "fit/surface_roughness.hpp"

namespace pcor::internal {

/// The name that a model had before it was fitted.
std::string unfitted_name(const ModelDefinition& model);

/// Gives a derived model a new name, "NAME, fitted to GOTEX rf06 2004-02-18", and the provenance list
/// `before` of its source models, oldest first: name, creation time and source of each, if known. Names do
/// not grow with the number of fits.
/// @param how "fitted to" or "improved on"
void record_provenance(ModelDefinition& made, const ModelDefinition& from, const std::string& how,
                       const std::string& flights);

/// `given` with the coefficients of a fit, their standard errors and covariance, a name with the fitted
/// flights, and its origin (`record_provenance`). Errors of held parameters and of the temperature are kept.
/// @param first index of the first parameter of this file in the fit
/// @param flights title of the fitted flights
ModelDefinition fitted_model(const ModelDefinition& given, std::size_t first, const RefitResult& fit,
                             Loss loss, const std::string& flights);

/// The model with the coefficients that `refit` finds, without their errors and without any statement on the
/// flights: for a model of which only the predictions are compared. Arguments and errors as `refit`.
/// @param surfaces in: initial priors of the surfaces, from a fit of the same model and references; empty:
/// the default sizes. Out: the priors of this fit; unchanged if a reference is by GPS
ModelDefinition fitted_coefficients(const FlightSet& flights, const ModelDefinition& model,
                                    const References& references, const RefitOptions& options,
                                    std::vector<SurfaceRoughness>& surfaces);

}  // namespace pcor::internal
