#pragma once

#include <pcor/campaign/flight_set.hpp>

#include <string>
#include <vector>

namespace pcor {

/// References of a comparison, and reasons against the others.
struct ChosenReferences {
  References used{};
  /// Default selection only: other references, and reasons against them.
  std::vector<std::string> not_used{};
};

/// Sorts reference names: LAMS first, then second systems, then references with a window of samples. The
/// first one determines every single figure that is reported.
std::vector<std::string> in_order(std::vector<std::string> texts);

/// References that `texts` name. Default: LAMS and all others that the model and every flight permit: total
/// pressure of a second pair of pressures, heights, and wind.
///
/// @throws Error as `read_reference`, or if there are neither texts nor LAMS: the other references do not
/// determine the static pressure alone.
ChosenReferences read_references(const std::vector<std::string>& texts, const ModelDefinition& model,
                                 const FlightSet& flights);

}  // namespace pcor
