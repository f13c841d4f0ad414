#include "campaign/circular_pressure.hpp"

#include <vector>

#include "parallel/flight_partition.hpp"
#include "roles/computed_from.hpp"

namespace pcor::internal {

std::string circular_pressure(const FlightSet& flights, const ModelDefinition& model,
                              const Reference& reference) {
  const std::string static_variable = model.variable_of(Quantity::static_pressure);
  if (static_variable.empty() || !reference.is_static_pressure()) return "";
  const std::vector<std::string> variables = reference.variables();
  const std::string other = reference.model() != nullptr
                                ? reference.model()->variable_of(Quantity::static_pressure)
                                : (variables.empty() ? "" : variables.front());
  if (other.empty()) return "";
  const FlightSet first = flights.part(0, 1);
  const bool is_in_file = !first.path(0).empty();
  const std::vector<int> is_circular = first.partition().all_gather_flights<int>([&](std::size_t flight) {
    return other == static_variable || (is_in_file && is_computed_from(first[flight], other, static_variable))
               ? 1
               : 0;
  });
  return is_circular.front() != 0 ? other : "";
}

}  // namespace pcor::internal
