#pragma once

#include <optional>
#include <string>

#include <pcor/base/note.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// A static or dynamic pressure that cannot be right.
struct ImpossiblePressure {
  Quantity role = Quantity::static_pressure;
  double ratio = 1.0;          ///< median ratio of recorded to expected pressure
  std::string against;         ///< "the value expected from the height GGALT", or the other pressure, "QCF"
  std::string unit;            ///< the unit in which it would be plausible; empty without such a unit
  bool are_exchanged = false;  ///< the static pressure of the model seems to be its dynamic pressure
};

/// Holds the static pressure of a model against the height, within 10 % of the standard atmosphere, more
/// above the tropopause, and against the static pressures of other systems, within 5 %; and the dynamic
/// pressure against the total pressures of other systems, within 10 %. Medians of the flight decide. Empty if
/// one of them agrees, unless the height shows that all are in a wrong unit; if the height shows that the
/// other system is wrong; if the heights fit at all heights as feet; if the flight has neither; or if the
/// model states the unit itself, which is accepted unless the dynamic pressure exceeds 1.5 times the static
/// pressure in 95 % of the samples in flight, 60 or more. Mach 1.2 gives 1.4.
std::optional<ImpossiblePressure> impossible_pressure(const Flight& flight, const ModelDefinition& model);

/// Adds a warning if another system contradicts the static pressure in a minute or more of the flight only.
///
/// @throws Error that names the variable, its unit, the contradicting evidence and the correction of the
/// model
void require_possible_pressure(const Flight& flight, const ModelDefinition& model, Notes& notes);

}  // namespace pcor::internal
