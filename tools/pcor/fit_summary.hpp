#pragma once

#include <CLI/CLI.hpp>

#include <pcor/fit/refit.hpp>

namespace pcor::tool {

/// Adds the option that sets `RefitOptions::trust_reference`.
void add_trust_option(CLI::App& command, bool& trust);

/// Prints a significant bias of held-out parts first, then the model error and the drift of the noise.
void print_fit_summary(const RefitResult& fit);

}  // namespace pcor::tool
