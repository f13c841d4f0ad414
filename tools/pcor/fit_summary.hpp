#pragma once

#include <pcor/fit/refit.hpp>

namespace pcor::tool {

/// Prints a significant bias of held-out parts first, then the model error and the drift of the noise.
void print_fit_summary(const RefitResult& fit);

}  // namespace pcor::tool
