#pragma once

#include <nlohmann/json.hpp>

#include <pcor/fit/refit.hpp>

namespace pcor::tool {

/// Prints first whether a held-out part is off, then what the law lacks and how much the noise drifts.
void print_fit_summary(const RefitResult& fit);

/// Adds the keys that `refit` and `improve` share: estimator, misfit, drift, and the held-out part that is
/// furthest off.
void add_fit_summary(nlohmann::ordered_json& json, const RefitResult& fit);

}  // namespace pcor::tool
