#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <pcor/fit/refit.hpp>

namespace pcor::tool {

/// Adds the option that sets `RefitOptions::trust_reference`.
void add_trust_option(CLI::App& command, bool& trust);

/// Prints a significant bias of held-out parts first, then the model error and the drift of the noise.
void print_fit_summary(const RefitResult& fit);

/// Adds the keys that `refit` and `improve` share: estimator, misfit, drift, and the held-out part with the
/// largest bias.
void add_fit_summary(nlohmann::ordered_json& json, const RefitResult& fit);

}  // namespace pcor::tool
