#pragma once

#include <string>

#include <pcor/flight/flight.hpp>

namespace pcor::internal {

/// Whether a variable is `source`, or was computed from it by up to `max_steps` steps of the attribute
/// Dependencies ("2 PSFD RATIO"). False without such attributes.
bool is_computed_from(const Flight& flight, const std::string& variable, const std::string& source,
                      int max_steps = 5);

}  // namespace pcor::internal
