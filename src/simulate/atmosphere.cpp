#include "simulate/atmosphere.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <pcor/base/error.hpp>
#include <pcor/physics/constants.hpp>

namespace pcor::internal::simulate {
namespace {

constexpr double step = 10.0;  // m; the interpolation error of ln p between levels is 4e-8
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
  const auto count = static_cast<std::size_t>((top - bottom_) / step) + 1;
  levels_.resize(count);
  log_pressure_.resize(count);
  const auto height = [this](std::size_t i) { return bottom_ + step * static_cast<double>(i); };
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
  const auto ground = static_cast<std::size_t>(below_ground / step);
  log_pressure_[ground] = std::log(a.ground_pressure);
  levels_[ground].pressure = a.ground_pressure;
  const auto integrate = [&](std::size_t from, std::size_t to, double dz) {
    const double here = slope(from, std::exp(log_pressure_[from]));
    const double there = slope(to, std::exp(log_pressure_[from] - here * dz));
    log_pressure_[to] = log_pressure_[from] - 0.5 * (here + there) * dz;
    levels_[to].pressure = std::exp(log_pressure_[to]);
  };
  for (std::size_t i = ground; i + 1 < count; ++i) integrate(i, i + 1, step);
  for (std::size_t i = ground; i > 0; --i) integrate(i, i - 1, -step);
}

Air Column::at(double height) const {
  const double position = std::clamp((height - bottom_) / step, 0.0, static_cast<double>(levels_.size() - 2));
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
