#include "roles/computed_from.hpp"

#include <algorithm>

#include "base/phrasing.hpp"

namespace pcor::internal {

bool is_computed_from(const Flight& flight, const std::string& variable, const std::string& source,
                      int max_steps) {
  if (variable == source) return true;
  if (max_steps == 0 || !flight.has(variable)) return false;
  const std::vector<std::string> inputs = split_words(flight.variable(variable).attribute("Dependencies"));
  return std::any_of(inputs.begin(), inputs.end(), [&](const std::string& input) {
    return input != variable && is_computed_from(flight, input, source, max_steps - 1);
  });
}

}  // namespace pcor::internal
