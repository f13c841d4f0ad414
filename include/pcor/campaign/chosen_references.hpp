#pragma once

#include <pcor/campaign/flight_set.hpp>

#include <string>
#include <vector>

namespace pcor {

/// What a model is held against, and what it could have been.
struct ChosenReferences {
  References used{};
  std::vector<std::string> not_used{};  ///< where no text named any: which else there are, and why not these
};

/// The texts of references in the one order in which a command takes them, however they were given: the first
/// decides where a single figure is told. LAMS comes first, then second systems, then what sees no single
/// sample.
std::vector<std::string> in_order(std::vector<std::string> texts);

/// The references that `texts` name; without texts LAMS, and all else that the model and every flight allow:
/// the total pressure of a second pair of pressures, heights, and wind.
///
/// @throws Error as `read_reference`, or if there is no text and no LAMS: the others do not tell a static
/// pressure by themselves.
ChosenReferences read_references(const std::vector<std::string>& texts, const ModelDefinition& model,
                                 const FlightSet& flights);

}  // namespace pcor
