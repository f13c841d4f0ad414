#pragma once

#include <cstddef>
#include <string>

#include <pcor/fit/refit.hpp>

namespace pcor::internal {

/// `given` with the coefficients of a fit, their standard errors and covariance, a name that says what it was
/// fitted to, and where it comes from (`descend`). What it knew of parameters that were held, and of the
/// temperature, stays.
/// @param first of the fit's parameters that is one of this file
/// @param flights what the fitted flights are called
ModelDefinition fitted_model(const ModelDefinition& given, std::size_t first, const RefitResult& fit,
                             Loss loss, const std::string& flights);

}  // namespace pcor::internal
