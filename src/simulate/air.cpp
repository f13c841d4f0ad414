#include "simulate/air.hpp"

#include <cmath>

#include <pcor/physics/constants.hpp>

namespace pcor::internal::simulate {
namespace {

constexpr double dry_gas_constant = constants::gas_constant_dry_air;
constexpr double vapor_gas_constant = constants::gas_constant_water_vapor;

// Magnus's law, Alduchov and Eskridge (1996).
constexpr double magnus_scale = 6.1094;  // hPa
constexpr double magnus_slope = 17.625;
constexpr double magnus_shift = 243.04;  // K

double vapor_mass_fraction(const Air& air) {
  const double vapor = air.vapor_pressure / vapor_gas_constant;
  const double dry = (air.pressure - air.vapor_pressure) / dry_gas_constant;
  return vapor / (vapor + dry);
}

}  // namespace

double gas_constant(const Air& air) {
  const double s = vapor_mass_fraction(air);
  return (1.0 - s) * dry_gas_constant + s * vapor_gas_constant;
}

double specific_heat(const Air& air) {
  const double s = vapor_mass_fraction(air);
  return (1.0 - s) * 3.5 * dry_gas_constant + s * 4.0 * vapor_gas_constant;
}

double density(const Air& air) {
  return pascal_per_hpa * air.pressure / (gas_constant(air) * air.temperature);
}

double speed_of_sound(const Air& air) {
  const double r = gas_constant(air);
  const double cp = specific_heat(air);
  return std::sqrt(cp / (cp - r) * r * air.temperature);
}

double total_pressure(const Air& air, double speed) {
  const double cp = specific_heat(air);
  const double stagnation = air.temperature + speed * speed / (2.0 * cp);
  return air.pressure * std::pow(stagnation / air.temperature, cp / gas_constant(air));
}

double recovery_temperature(const Air& air, double speed, double recovery) {
  return air.temperature + recovery * speed * speed / (2.0 * specific_heat(air));
}

double dry_mach(double static_pressure, double dynamic_pressure) {
  if (!(dynamic_pressure > 0.0)) return 0.0;
  return std::sqrt(5.0 * std::expm1(std::log1p(dynamic_pressure / static_pressure) * 2.0 / 7.0));
}

double saturation_pressure(double temperature) {
  const double celsius = temperature - constants::ice_point;
  return magnus_scale * std::exp(magnus_slope * celsius / (magnus_shift + celsius));
}

double dew_point(double vapor_pressure) {
  const double logarithm = std::log(vapor_pressure / magnus_scale);
  return constants::ice_point + magnus_shift * logarithm / (magnus_slope - logarithm);
}

}  // namespace pcor::internal::simulate
