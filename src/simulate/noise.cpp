#include "simulate/noise.hpp"

#include "simulate/aircraft.hpp"
#include "simulate/truth.hpp"

namespace pcor::internal::simulate {

std::map<std::string, Scenario::Noise> usual_noise(const Scenario& scenario) {
  constexpr double minute = 60.0;  // s
  std::map<std::string, Scenario::Noise> noise{
      {"QCR", {0.03, 0.0, 0.0, 0.002}},    {"ADIFR", {0.02, 0.0, 0.0, 0.002}},
      {"BDIFR", {0.02, 0.0, 0.0, 0.002}},  {"EDPC", {0.02, 0.0, minute, 0.0}},
      {"DPXC", {0.1, 0.0, minute, 0.0}},   {"VLAMS", {0.05, 0.0, 0.0, 0.01}},
      {"PS_A", {0.1, 0.0, 0.0, 0.01}},     {"QC_A", {0.1, 0.0, 0.0, 0.01}},
      {"MACH_A", {2e-4, 0.0, 0.0, 1e-5}},  {"TASX", {0.2, 0.0, 0.0, 0.0}},
      {"PITCH", {0.02, 0.0, 0.0, 0.0}},    {"ROLL", {0.02, 0.0, 0.0, 0.0}},
      {"THDG", {0.04, 0.0, minute, 0.0}},  {"GGTRK", {0.02, 0.0, 0.0, 0.0}},
      {"GGSPD", {0.03, 0.0, minute, 0.0}}, {"GGALT", {0.15, 0.0, minute, 0.0}},
      {"GGVSPD", {0.03, 0.0, 0.0, 0.0}},   {"BNORMA", {0.02, 0.0, 0.0, 0.0}},
      {"PLWCC", {0.003, 0.0, 0.0, 0.0}},   {"PCAB", {0.2, 0.0, 0.0, 0.0}},
      {"ENGTRQ", {0.3, 0.0, 0.0, 0.0}},    {"TBAY", {0.05, 0.0, 0.0, 0.0}},
      {"RALT", {0.3, 0.0, 0.0, 0.0}},      {"BLONA", {0.02, 0.0, 0.0, 0.0}},
  };
  const AircraftInfo& aircraft = info_of(scenario.aircraft);
  for (const Thermometer& thermometer : {aircraft.thermometer, aircraft.second_thermometer})
    noise[std::string(thermometer.name)] = {0.1, 0.0, 0.0, 0.0};
  for (const Scenario::System& system : scenario.systems) {
    noise[system.static_pressure] = {0.01, 0.0, 0.0, 0.001};
    noise[system.dynamic_pressure] = {0.03, 0.0, 0.0, 0.001};
  }
  for (const TruthInfo& info : truth_info) {
    if (!info.recorded.empty()) noise.try_emplace(std::string(info.recorded));
  }
  return noise;
}

}  // namespace pcor::internal::simulate
