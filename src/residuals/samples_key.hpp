#pragma once

#include <cstdint>
#include <string>

#include <pcor/model_io/model_definition.hpp>
#include <pcor/residuals/masks.hpp>
#include <pcor/residuals/reference.hpp>

namespace pcor::internal {

/// A text that is the same for two models that read the same of a flight: its variables and units, and what
/// its effects need. The coefficients of the effects count only where a column depends on one of them
/// (`find_moving_columns`, `airspeed_along_beam`).
/// @throws Error if the model cannot be used on its roles
std::string inputs_of(const ModelDefinition& model, bool with_laser);

/// A number that is the same where `read_samples` gives the same of a flight, except for a chance of 2^-64.
/// @throws Error as `inputs_of`
std::uint64_t samples_key(const ModelDefinition& model, const Reference& reference, const MaskOptions& mask);

}  // namespace pcor::internal
