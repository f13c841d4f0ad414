#pragma once

#include <cstddef>
#include <string>

#include <pcor/fit/refit.hpp>

namespace pcor::internal {

/// `given` with the coefficients of a fit, their standard errors and covariance, a name with the fitted
/// flights, and its origin (`descend`). Errors of held parameters and of the temperature are kept.
/// @param first index of the first parameter of this file in the fit
/// @param flights title of the fitted flights
ModelDefinition fitted_model(const ModelDefinition& given, std::size_t first, const RefitResult& fit,
                             Loss loss, const std::string& flights);

}  // namespace pcor::internal
