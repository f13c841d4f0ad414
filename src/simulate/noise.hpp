#pragma once

#include <map>
#include <pcor/simulate/simulate.hpp>
#include <string>

namespace pcor::internal::simulate {

/// The usual noise of every variable that the scenario's instruments record, by name.
///
/// Rms of 1-s means and resolutions, no biases: Cooper et al., wind uncertainty of the GV (NCAR technical
/// note), for pressures, attitude and GPS; others are estimates. GPS and heading errors have a memory of a
/// minute.
std::map<std::string, Scenario::Noise> usual_noise(const Scenario& scenario);

}  // namespace pcor::internal::simulate
