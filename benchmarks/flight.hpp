#pragma once

#include <cstddef>
#include <vector>

#include <pcor/batch/batch.hpp>
#include <pcor/model/model.hpp>

namespace pcor::benchmarks {

/// Synthetic flight of a jet: climb to 200 hPa, level legs and descent through humid and dry air, with noise.
struct Flight {
  std::vector<double> static_pressure;       // hPa
  std::vector<double> dynamic_pressure;      // hPa
  std::vector<double> recovery_temperature;  // K
  std::vector<double> vapor_pressure;        // hPa
  std::vector<double> attack;                // deg
  std::vector<double> lams_airspeed;         // m/s

  std::size_t size() const { return static_pressure.size(); }

  /// Arrays of the `recorded_roles`.
  std::vector<Batch::Input> inputs() const;
};

Flight make_flight(std::size_t samples);

/// Roles of the arrays of a flight, except LAMS.
std::vector<Quantity> recorded_roles();

/// Static defect of the GV of 2014 with an unheated Rosemount thermometer, in moist air.
Model gv_2014();

}  // namespace pcor::benchmarks
