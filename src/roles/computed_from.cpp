#include "roles/computed_from.hpp"

#include <algorithm>

#include "base/phrasing.hpp"

namespace pcor::internal {
namespace {

bool leads_to(const Flight& flight, const std::string& variable, const std::string& source, int steps) {
  if (variable == source) return true;
  if (steps == 0 || !flight.has(variable)) return false;
  const std::vector<std::string> inputs = split_words(flight.variable(variable).attribute("Dependencies"));
  return std::any_of(inputs.begin(), inputs.end(), [&](const std::string& input) {
    return input != variable && leads_to(flight, input, source, steps - 1);
  });
}

}  // namespace

bool is_computed_from(const Flight& flight, const std::string& variable, const std::string& source) {
  constexpr int max_steps = 5;
  return leads_to(flight, variable, source, max_steps);
}

}  // namespace pcor::internal
