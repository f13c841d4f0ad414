#pragma once

#include <string>
#include <vector>

#include <pcor/model/quantity.hpp>

namespace pcor::internal {

/// The variables that NCAR's files usually have for a role, the likeliest first. Empty for the roles that a
/// model must name itself, because several instruments measure them and the choice is a part of the model:
/// pressures, temperatures, humidity, the laser, the Mach number.
std::vector<std::string> usual_variables(Quantity role);

/// The usual variables of the ground velocity to the east and to the north, m/s, for files without its size
/// and direction, the likeliest first. They have no role.
struct GroundVelocityVariables {
  std::vector<std::string> east{"GGVEW", "VEWC", "VEW"};
  std::vector<std::string> north{"GGVNS", "VNSC", "VNS"};
};

}  // namespace pcor::internal
