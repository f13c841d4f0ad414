#pragma once

#include <optional>
#include <string>
#include <vector>

#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// Inputs of a model from a flight, including rates of change and the time since the first record. Without
/// `with_laser` the model is used as if it had no laser. Adds notes for the user to `notes`, one sentence
/// each.
/// @throws Error if the model cannot be used, a variable is absent or has no value, or its unit does not fit.
ModelSamples read_model_columns(const Flight& flight, const ModelDefinition& model, bool with_laser,
                                const std::vector<double>& time, Notes& notes);

/// Marks the records with flaps extended by more than `flaps_in`: by the recorded flaps, also on the ground,
/// otherwise inferred from the lift (`find_flaps_by_lift`), where slow records of the take-off and the
/// landing are not marked. Nullopt if the flaps are neither recorded nor determined by the lift.
/// @param model names the static and the dynamic pressure of the flight; other roles are optional
/// @throws Error if a variable cannot be read
std::optional<std::vector<bool>> flaps_extended(const Flight& flight, const ModelDefinition& model);

}  // namespace pcor::internal
