#pragma once

#include <pcor/model_io/model_definition.hpp>
#include <pcor/simulate/simulate.hpp>

#include <filesystem>

#include "support/temporary_directory.hpp"

namespace pcor::test {

inline const std::filesystem::path scenarios = std::filesystem::path(PCOR_SOURCE_DIR) / "data" / "scenarios";

/// A quarter of an hour of the C-130 with the laser and a few minutes of everything, simulated once.
inline const std::filesystem::path& short_flight() {
  static const TemporaryDirectory directory;
  static const std::filesystem::path path = [] {
    simulate_flight(read_scenario(scenarios / "c130-short.toml"), directory / "short.nc");
    return directory / "short.nc";
  }();
  return path;
}

/// The law with which that flight was simulated, and the variable of the laser.
inline ModelDefinition laser_model() { return read_model(scenarios / "models" / "c130-psfd-eq18.toml"); }

}  // namespace pcor::test
