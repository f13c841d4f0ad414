#pragma once

#include <pcor/fit/refit.hpp>

namespace pcor::internal {

/// The model with the coefficients that `refit` finds, without their errors and without any statement on the
/// flights: for a model of which only the predictions are compared. Arguments and errors as `refit`.
ModelDefinition fitted_coefficients(const FlightSet& flights, const ModelDefinition& model,
                                    const References& references, const RefitOptions& options);

}  // namespace pcor::internal
