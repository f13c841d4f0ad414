#pragma once

#include <pcor/model/quantity.hpp>

#include <map>
#include <vector>

namespace pcor::test {

using Sample = std::map<Quantity, double>;

/// Level flight at 700 hPa, with LAMS.
inline const Sample level{{Quantity::static_pressure, 700.0},
                          {Quantity::dynamic_pressure, 67.6},
                          {Quantity::radome_dynamic_pressure, 67.1},
                          {Quantity::attack_differential_pressure, -15.3},
                          {Quantity::sideslip_differential_pressure, 1.2},
                          {Quantity::recovery_temperature, 280.0},
                          {Quantity::vapor_pressure, 4.2},
                          {Quantity::lams_airspeed, 117.0}};

inline std::vector<Quantity> roles_of(const Sample& sample) {
  std::vector<Quantity> roles;
  for (const auto& [role, value] : sample) roles.push_back(role);
  return roles;
}

}  // namespace pcor::test
