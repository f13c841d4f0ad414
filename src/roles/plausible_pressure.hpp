#pragma once

#include <optional>
#include <string>

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// A static pressure that cannot be right.
struct ImpossiblePressure {
  double ratio = 1.0;   ///< of the recorded pressure to the one that is expected, the median
  std::string against;  ///< "the height GGALT"
  std::string unit;     ///< in which it would be right; empty where none makes it so
};

/// Holds the static pressure of a model against the height, within 10 % of the standard atmosphere, more
/// above the tropopause, and against the static pressures of other systems, within 5 %. Nothing where it
/// agrees, where the flight has neither, or where the model states the unit itself: that is believed.
std::optional<ImpossiblePressure> impossible_pressure(const Flight& flight, const ModelDefinition& model);

/// @throws Error that names the variable, its unit, what speaks against it, and what to write into the model
void require_possible_pressure(const Flight& flight, const ModelDefinition& model);

}  // namespace pcor::internal
