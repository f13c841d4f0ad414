#include "flight.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <pcor/physics/air_data.hpp>
#include <pcor/physics/humidity.hpp>
#include <pcor/physics/recovery_factor.hpp>

namespace pcor::benchmarks {

Flight make_flight(std::size_t samples) {
  std::mt19937_64 random(2014);
  std::normal_distribution<double> noise;
  const RecoveryFactor recovery = gv_2014().recovery;
  Flight flight;
  for (std::size_t i = 0; i < samples; ++i) {
    const double x = static_cast<double>(i) / static_cast<double>(samples);
    // Climb in the first fifth, descent in the last fifth; the cruising level varies between them.
    const double climbed = std::min({1.0, 5.0 * x, 5.0 * (1.0 - x)});
    const double p = 1000.0 - climbed * (760.0 + 40.0 * std::sin(20.0 * x)) + 0.05 * noise(random);
    const double mach = 0.2 + 0.58 * climbed + 0.002 * noise(random);
    const double altitude = 44330.8 * (1.0 - std::pow(p / 1013.25, 0.190263));
    const double temperature = 288.15 - 0.0065 * altitude + 0.1 * noise(random);
    const double relative_humidity = 0.5 + 0.47 * std::sin(70.0 * x) + 0.02 * noise(random);
    const double e = relative_humidity * vapor_pressure_over_water(temperature);
    const MoistAir<double> air = moist_air(e / p);
    const double defect = 0.004 * p;
    flight.static_pressure.push_back(p - defect);
    flight.dynamic_pressure.push_back(dynamic_pressure_from_mach(p, mach, air) + defect);
    flight.recovery_temperature.push_back(pcor::recovery_temperature(temperature, mach, recovery(mach), air));
    flight.vapor_pressure.push_back(e);
    flight.attack.push_back(2.5 + 2.0 * (1.0 - climbed) + 0.2 * noise(random));
    flight.lams_airspeed.push_back(true_airspeed(mach, temperature, air));
  }
  return flight;
}

std::vector<Batch::Input> Flight::inputs() const {
  return {{Quantity::static_pressure, static_pressure.data()},
          {Quantity::dynamic_pressure, dynamic_pressure.data()},
          {Quantity::recovery_temperature, recovery_temperature.data()},
          {Quantity::vapor_pressure, vapor_pressure.data()},
          {Quantity::attack, attack.data()}};
}

std::vector<Quantity> recorded_roles() {
  return {Quantity::static_pressure, Quantity::dynamic_pressure, Quantity::recovery_temperature,
          Quantity::vapor_pressure, Quantity::attack};
}

Model gv_2014() {
  Model model;
  model.name = "gv-2014";
  model.effects = {{"static-constant", {-0.012255}},
                   {"static-qp", {0.075372}},
                   {"static-mach3", {-0.087508}},
                   {"static-attack", {0.002148}}};
  model.recovery = {{0.9959, 0.0283, 0.0374, 0.0762}};
  model.policy.taper_below = 40.0;
  return model;
}

}  // namespace pcor::benchmarks
