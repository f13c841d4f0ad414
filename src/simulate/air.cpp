#include "simulate/air.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <pcor/base/error.hpp>
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

/// Specific heat at constant pressure, J/(kg K): 7/2 R_d and 4 R_w by mass.
double specific_heat(const Air& air) {
  const double s = vapor_mass_fraction(air);
  return (1.0 - s) * 3.5 * dry_gas_constant + s * 4.0 * vapor_gas_constant;
}

constexpr double level_spacing = 10.0;  // m; the interpolation error of ln p between levels is 4e-8
constexpr double below_ground = 500.0;
constexpr double top = 18000.0;
constexpr double inversion_depth = 200.0;  // m
constexpr double dry_above = 2.0;          // %, at the tropopause

double blend(double height, double from, double to) {
  const double x = std::clamp((height - from) / (to - from), 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

double temperature(const Scenario::Atmosphere& a, double height) {
  const double risen = std::min(height, a.tropopause) - a.ground_height;
  return a.ground_temperature - a.lapse_rate * 1e-3 * risen +
         a.inversion_strength * blend(height, a.inversion_height, a.inversion_height + inversion_depth);
}

double vapor_pressure(const Scenario::Atmosphere& a, double height) {
  const double mixed = blend(height, a.inversion_height, a.inversion_height + inversion_depth);
  const double moist = a.ground_humidity + (a.upper_humidity - a.ground_humidity) * mixed;
  const double high = blend(height, 0.5 * a.tropopause, a.tropopause);
  const double humidity = moist + (std::min(dry_above, moist) - moist) * high;
  return 0.01 * humidity * saturation_pressure(temperature(a, height));
}

}  // namespace

double gas_constant(const Air& air) {
  const double s = vapor_mass_fraction(air);
  return (1.0 - s) * dry_gas_constant + s * vapor_gas_constant;
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

double gravity(double latitude, double height) {
  const double sine = std::sin(latitude * constants::radians_per_degree);
  const double square = sine * sine;
  const double surface =
      9.7803253359 * (1.0 + 0.00193185265241 * square) / std::sqrt(1.0 - 0.00669437999014 * square);
  constexpr double earth_radius = 6378137.0;  // m, the semi-major axis of WGS 84
  const double across = height / earth_radius;
  return surface * (1.0 - 2.0 * (1.00680267 - 0.00670562 * square) * across + 3.0 * across * across);
}

Column::Column(const Scenario::Atmosphere& a, double latitude) : bottom_(a.ground_height - below_ground) {
  const auto count = static_cast<std::size_t>((top - bottom_) / level_spacing) + 1;
  levels_.resize(count);
  log_pressure_.resize(count);
  const auto height = [this](std::size_t i) { return bottom_ + level_spacing * static_cast<double>(i); };
  for (std::size_t i = 0; i < count; ++i) {
    levels_[i].temperature = temperature(a, height(i));
    levels_[i].vapor_pressure = vapor_pressure(a, height(i));
    if (levels_[i].temperature < 150.0)
      throw Error(Error::Code::definition,
                  fmt::format("the air would have {:.0f} K at {:.0f} m; give a smaller lapse_rate or a lower "
                              "tropopause",
                              levels_[i].temperature, height(i)));
  }
  // d ln p/dz = -g/(R T), trapezium rule; R needs p itself, which the level before gives well enough.
  const auto slope = [&](std::size_t i, double pressure) {
    levels_[i].pressure = pressure;
    return gravity(latitude, height(i)) / (gas_constant(levels_[i]) * levels_[i].temperature);
  };
  const auto ground = static_cast<std::size_t>(below_ground / level_spacing);
  log_pressure_[ground] = std::log(a.ground_pressure);
  levels_[ground].pressure = a.ground_pressure;
  const auto integrate = [&](std::size_t from, std::size_t to, double dz) {
    const double here = slope(from, std::exp(log_pressure_[from]));
    const double there = slope(to, std::exp(log_pressure_[from] - here * dz));
    log_pressure_[to] = log_pressure_[from] - 0.5 * (here + there) * dz;
    levels_[to].pressure = std::exp(log_pressure_[to]);
  };
  for (std::size_t i = ground; i + 1 < count; ++i) integrate(i, i + 1, level_spacing);
  for (std::size_t i = ground; i > 0; --i) integrate(i, i - 1, -level_spacing);
}

Air Column::at(double height) const {
  const double position =
      std::clamp((height - bottom_) / level_spacing, 0.0, static_cast<double>(levels_.size() - 2));
  const auto i = static_cast<std::size_t>(position);
  const double part = position - static_cast<double>(i);
  const auto between = [part](double a, double b) { return a + (b - a) * part; };
  return {std::exp(between(log_pressure_[i], log_pressure_[i + 1])),
          between(levels_[i].temperature, levels_[i + 1].temperature),
          between(levels_[i].vapor_pressure, levels_[i + 1].vapor_pressure)};
}

double dissipation(const Scenario::Atmosphere& a, double height) {
  const double free = blend(height, a.inversion_height, a.inversion_height + 300.0);
  return std::pow(a.boundary_layer, 1.0 - free) * std::pow(a.turbulence, free);
}

}  // namespace pcor::internal::simulate
