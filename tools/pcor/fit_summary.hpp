#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <pcor/fit/refit.hpp>

namespace pcor::tool {

/// Adds the option that sets `RefitOptions::trust_reference`.
void add_trust_option(CLI::App& command, bool& trust);

/// Prints first whether a held-out part is off, then what the law lacks and how much the noise drifts.
void print_fit_summary(const RefitResult& fit);

/// Adds the keys that `refit` and `improve` share: estimator, misfit, drift, and the held-out part that is
/// furthest off.
void add_fit_summary(nlohmann::ordered_json& json, const RefitResult& fit);

}  // namespace pcor::tool
