#pragma once

#include <string>
#include <vector>

#include "pcor/realtime/quantity.hpp"

namespace pcor {

/// The variables that NCAR's files usually have for a role, the likeliest first. Empty for the roles that a
/// model must name itself, because several instruments measure them and the choice is a part of the model:
/// pressures, temperatures, humidity, the laser, the Mach number.
std::vector<std::string> usual_variables(Quantity role);

}  // namespace pcor
