#include "roles/computed_from.hpp"

#include <sstream>

namespace pcor::internal {
namespace {

bool leads_to(const Flight& flight, const std::string& variable, const std::string& source, int steps) {
  if (variable == source) return true;
  if (steps == 0 || !flight.has(variable)) return false;
  for (const auto& [name, value] : flight.variable(variable).attributes) {
    if (name != "Dependencies") continue;
    std::istringstream words(value);
    for (std::string word; words >> word;) {
      if (word != variable && leads_to(flight, word, source, steps - 1)) return true;
    }
  }
  return false;
}

}  // namespace

bool is_computed_from(const Flight& flight, const std::string& variable, const std::string& source) {
  constexpr int max_steps = 5;
  return leads_to(flight, variable, source, max_steps);
}

}  // namespace pcor::internal
