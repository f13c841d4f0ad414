#pragma once

#include <string>

#include <pcor/flight/flight.hpp>

namespace pcor::internal {

/// Whether a variable is `source`, or was computed from it by up to five steps of the attribute Dependencies
/// ("2 PSFD RATIO"). False without such attributes.
bool is_computed_from(const Flight& flight, const std::string& variable, const std::string& source);

}  // namespace pcor::internal
