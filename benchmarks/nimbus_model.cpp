#include "nimbus_model.hpp"

#include <algorithm>
#include <cmath>

namespace nimbus_model {
namespace {

constexpr double gas_constant_dry_air = 8314.472 / 28.9637;
constexpr double molar_mass_ratio = 18.0153 / 28.9637;

// Gas constants of the moist air of the last sample.
double gas_constant = gas_constant_dry_air;
double specific_heat_pressure = 3.5 * gas_constant_dry_air;
double specific_heat_volume = 2.5 * gas_constant_dry_air;

double get(const Derivation& derivation, const Sample& sample, std::size_t number) {
  return sample[derivation.inputs[number]];
}

void put(const Derivation& derivation, Sample& sample, double value) { sample[derivation.output] = value; }

double dry_mach_squared(double p, double q) { return 5.0 * (std::pow(1.0 + q / p, 2.0 / 7.0) - 1.0); }

// Static defect of the GV of 2014, hPa.
double static_defect(double p, double q, double attack) {
  if (std::isnan(attack)) attack = 3.0;
  const double mach = std::sqrt(dry_mach_squared(p, q));
  const double defect =
      p * (-0.012255 + 0.075372 * q / p - 0.087508 * mach * mach * mach + 0.002148 * attack);
  return q < 40.0 ? defect * std::pow(q / 40.0, 3.0) : defect;
}

double recovery_factor(double mach) {
  const double logarithm = std::log10(mach);
  return 0.9959 + logarithm * (0.0283 + logarithm * (0.0374 + logarithm * 0.0762));
}

// Murphy and Koop (2005), eq. 10, hPa.
double saturation_vapor_pressure(double temperature) {
  return 0.01 *
         std::exp(
             54.842763 - 6763.22 / temperature - 4.21 * std::log(temperature) + 0.000367 * temperature +
             std::tanh(0.0415 * (temperature - 218.8)) *
                 (53.878 - 1331.22 / temperature - 9.44523 * std::log(temperature) + 0.014025 * temperature));
}

void corrected_static_pressure(const Derivation& self, Sample& sample) {
  const double p = get(self, sample, 0);
  const double q = get(self, sample, 1);
  put(self, sample, p + static_defect(p, q, get(self, sample, 2)));
}

void corrected_dynamic_pressure(const Derivation& self, Sample& sample) {
  const double q = get(self, sample, 0);
  const double p = get(self, sample, 1);
  put(self, sample, q - static_defect(p, q, get(self, sample, 2)));
}

void mach_number(const Derivation& self, Sample& sample) {
  const double q = get(self, sample, 0);
  const double p = get(self, sample, 1);
  const double heating = std::pow(1.0 + q / p, gas_constant / specific_heat_pressure) - 1.0;
  put(self, sample, std::sqrt(2.0 * specific_heat_volume / gas_constant * heating));
}

// Vapor pressure, at most saturation at the temperature of dry air, over static pressure. Sets the gas
// constants.
void humidity(const Derivation& self, Sample& sample) {
  const double q = get(self, sample, 0);
  const double p = get(self, sample, 1);
  const double thermometer = get(self, sample, 2);
  double e = get(self, sample, 3);
  const double mach2 = dry_mach_squared(p, q);
  const double temperature = thermometer / (1.0 + 0.2 * mach2 * recovery_factor(std::sqrt(mach2)));
  e = std::isnan(e) ? 0.0 : std::clamp(e, 0.0, saturation_vapor_pressure(temperature));
  const double ratio = e / p;
  gas_constant = gas_constant_dry_air / (1.0 + (molar_mass_ratio - 1.0) * ratio);
  specific_heat_volume = 2.5 * gas_constant * (1.0 + ratio / 5.0);
  specific_heat_pressure = 3.5 * gas_constant * (1.0 + ratio / 7.0);
  put(self, sample, ratio);
}

void ambient_temperature(const Derivation& self, Sample& sample) {
  const double thermometer = get(self, sample, 0);
  const double mach = get(self, sample, 1);
  const double heating = gas_constant / (2.0 * specific_heat_volume) * recovery_factor(mach) * mach * mach;
  put(self, sample, thermometer / (1.0 + heating));
}

void true_airspeed(const Derivation& self, Sample& sample) {
  const double temperature = get(self, sample, 0);
  const double mach = get(self, sample, 1);
  const double gamma = specific_heat_pressure / specific_heat_volume;
  put(self, sample, mach * std::sqrt(gamma * gas_constant * temperature));
}

}  // namespace

std::vector<Derivation> chain() {
  return {{corrected_static_pressure, {PSX, QCX, AKRD}, PSXC},
          {corrected_dynamic_pressure, {QCX, PSX, AKRD}, QCXC},
          {mach_number, {QCXC, PSXC}, MACHX},
          {humidity, {QCXC, PSXC, TTX, EWX}, TASFLG},
          {ambient_temperature, {TTX, MACHX}, ATX},
          {true_airspeed, {ATX, MACHX}, TASX}};
}

}  // namespace nimbus_model
