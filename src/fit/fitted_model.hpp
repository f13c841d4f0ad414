#pragma once

#include <cstddef>

#include <pcor/fit/refit.hpp>

namespace pcor::internal {

/// `file` with the coefficients of a fit, their standard errors and covariance, and where they come from.
/// What it knew of parameters that were held, and of the temperature, stays.
/// @param first of the fit's parameters that is one of this file
ModelFile fitted_model(ModelFile file, std::size_t first, const RefitResult& fit, Loss loss);

}  // namespace pcor::internal
