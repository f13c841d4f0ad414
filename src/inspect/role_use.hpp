#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <pcor/model/quantity.hpp>

namespace pcor::internal {

/// Consequence if a series is not recorded, in addition to the effects that need it; empty if no consequence
/// is known.
std::string cost_of(std::string_view series);

/// Effects that need a role, also as a source of a derived quantity.
std::vector<std::string> effects_that_need(Quantity role);

}  // namespace pcor::internal
