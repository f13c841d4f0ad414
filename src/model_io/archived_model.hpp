#pragma once

#include <array>
#include <string>

#include <pcor/model_io/model_definition.hpp>
#include <pcor/realtime/stages.hpp>

namespace pcor::internal {

/// Quantities that a temperature fit reads from a flight in addition to the quantities of the model: height,
/// position and attitude.
inline constexpr std::array motion_quantities{
    Quantity::altitude, Quantity::latitude, Quantity::ground_speed,   Quantity::ground_track,
    Quantity::heading,  Quantity::roll,     Quantity::vertical_speed, Quantity::flaps};

/// Part of a model that determines the corrected pressures and the temperature, as the text of a model file:
/// two models with the same text correct a flight identically. Excluded are the temperature correction, which
/// `pcor process` archives separately, variables that are not read, the laser if it does not correct, and
/// metadata: names, source and domain, errors of the parameters, and provenance.
/// @throws Error if the model cannot be used.
std::string archived_model(const ModelDefinition& model, CorrectWith correct_with);

/// Difference of two such texts, for a message: "parameters = { a0 = 0.004 } in the file, parameters = { a0 =
/// 0.005 } in the model". Empty if they are equal.
std::string archived_difference(const std::string& archived, const std::string& given);

}  // namespace pcor::internal
