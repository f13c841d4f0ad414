#pragma once

#include <pcor/model_io/model_definition.hpp>
#include <pcor/simulate/simulate.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "support/data.hpp"
#include "support/temporary_directory.hpp"

namespace pcor::test {

inline std::string scenario_text(const std::string& scenario) {
  std::ifstream file(scenarios / (scenario + ".toml"));
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Flight of a scenario with additional lines `more`, simulated once.
inline std::filesystem::path simulated(const std::string& scenario, const std::string& more = "") {
  static const TemporaryDirectory directory;
  static std::map<std::string, std::filesystem::path> flights;
  std::filesystem::path& path = flights[scenario + more];
  if (path.empty()) {
    path = directory / (std::to_string(flights.size()) + ".nc");
    simulate_flight(parse_scenario(scenario_text(scenario) + more, scenario), path);
  }
  return path;
}

/// Flight of the C-130 of 15 minutes with laser and short manoeuvres, simulated once.
inline const std::filesystem::path& short_flight() {
  static const TemporaryDirectory directory;
  static const std::filesystem::path path = [] {
    simulate_flight(read_scenario(scenarios / "c130-short.toml"), directory / "short.nc");
    return directory / "short.nc";
  }();
  return path;
}

/// Model of the simulated `short_flight`, with the laser.
inline ModelDefinition laser_model() { return read_model(scenarios / "models" / "c130-psfd-eq18.toml"); }

}  // namespace pcor::test
