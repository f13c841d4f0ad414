#pragma once

#include <cstdint>
#include <string>

#include <pcor/model_io/model_definition.hpp>
#include <pcor/residuals/masks.hpp>
#include <pcor/residuals/reference.hpp>

namespace pcor::internal {

/// Text that is identical for two models with the same inputs from a flight: variables and units, and the
/// inputs of its effects. The coefficients of the effects count only if a column depends on one of them
/// (`find_moving_columns`, `airspeed_along_beam`).
/// @throws Error if the model cannot be used on its roles
std::string inputs_of(const ModelDefinition& model, bool with_laser);

/// Key that is identical if `read_samples` returns the same samples of a flight, and different otherwise
/// except with probability 2^-64.
/// @throws Error as does `inputs_of`
std::uint64_t samples_key(const ModelDefinition& model, const Reference& reference, const MaskOptions& mask);

}  // namespace pcor::internal
