#pragma once

#include <string>
#include <vector>

#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// What a model reads of a flight, rates of change and the time since the first record included. Without
/// `with_laser` it is used as if it had none. Adds to `notes` what a user should know, a sentence each.
/// @throws Error if the model cannot be used, a variable is absent or has no value, or its unit does not fit.
ModelSamples read_model_columns(const Flight& flight, const ModelDefinition& model, bool with_laser,
                                const std::vector<double>& time, std::vector<std::string>& notes);

}  // namespace pcor::internal
