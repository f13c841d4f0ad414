#pragma once

#include <array>
#include <string>

#include <pcor/model_io/model_definition.hpp>
#include <pcor/realtime/stages.hpp>

namespace pcor::internal {

/// What a fit of temperature needs of a flight besides the quantities of the model: the height, the way, and
/// how it was flown.
inline constexpr std::array flown_quantities{
    Quantity::altitude, Quantity::latitude, Quantity::ground_speed,   Quantity::ground_track,
    Quantity::heading,  Quantity::roll,     Quantity::vertical_speed, Quantity::flaps};

/// What of a model decides the corrected pressures and the temperature, as the text of a model file: the same
/// text for two models says that they make the same of a flight. Left out are the correction of the
/// temperature, which `pcor process` archives apart, variables that these do not need, the laser where it
/// does not correct, and what a model only says: its names, source and domain, errors of its parameters, and
/// how it came to be.
/// @throws Error if the model cannot be used.
std::string archived_model(const ModelDefinition& model, CorrectWith correct_with);

/// How two such texts differ, for a message: "parameters = { a0 = 0.004 } in the file, parameters = { a0 =
/// 0.005 } in the model". Empty where they are the same.
std::string archived_difference(const std::string& archived, const std::string& given);

}  // namespace pcor::internal
