#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <pcor/physics/geodesy.hpp>

namespace pcor {

/// A layer of the US Standard Atmosphere 1976, from `base` to the base of the next.
struct StandardLayer {
  double base;         ///< geopotential height, m
  double temperature;  ///< temperature at the base, K
  double lapse;        ///< dT/dH, K/m
  double pressure;     ///< pressure at the base, hPa
};

/// The layers up to 71 km, table 4 of the source; the pressures at their bases follow from the layers below.
inline constexpr std::array<StandardLayer, 7> standard_layers{{
    {0.0, 288.15, -0.0065, 1013.25},
    {11000.0, 216.65, 0.0, 226.32063973462922},
    {20000.0, 216.65, 0.001, 54.748886696777774},
    {32000.0, 228.65, 0.0028, 8.680186847552287},
    {47000.0, 270.65, 0.0, 1.1090630555496603},
    {51000.0, 270.65, -0.0028, 0.6693887311868735},
    {71000.0, 214.65, -0.002, 0.039564204280407314},
}};

/// g0 M0/R*, K/m: 0.034163195, with the constants of the US Standard Atmosphere 1976, which are its own.
inline constexpr double standard_hydrostatic_constant = constants::standard_gravity * 28.9644 / 8314.32;

/// Top of this standard atmosphere, geopotential m; it extends down to -5000 m.
inline constexpr double standard_top = 84852.0;

inline constexpr double standard_bottom = -5000.0;

/// Temperature of the US Standard Atmosphere 1976, K, at the geopotential `height`, m. Domain: -5000 to
/// 84 852 m; outside it and for NaN, NaN. Exact. Source: NOAA-S/T 76-1562 (1976), eq. 23.
inline double standard_temperature(double height) {
  if (!(height >= standard_bottom && height <= standard_top)) return std::numeric_limits<double>::quiet_NaN();
  std::size_t layer = standard_layers.size() - 1;
  while (layer > 0 && height < standard_layers[layer].base) --layer;
  return standard_layers[layer].temperature +
         standard_layers[layer].lapse * (height - standard_layers[layer].base);
}

/// Pressure of the US Standard Atmosphere 1976, hPa, at the geopotential `height`, m. Domain as
/// `standard_temperature`; accuracy 1e-12. Source: NOAA-S/T 76-1562, eq. 33a and 33b.
inline double standard_pressure(double height) {
  if (!(height >= standard_bottom && height <= standard_top)) return std::numeric_limits<double>::quiet_NaN();
  std::size_t number = standard_layers.size() - 1;
  while (number > 0 && height < standard_layers[number].base) --number;
  const StandardLayer& layer = standard_layers[number];
  const double above = height - layer.base;
  if (layer.lapse == 0.0)
    return layer.pressure * std::exp(-standard_hydrostatic_constant * above / layer.temperature);
  return layer.pressure * std::pow(1.0 + layer.lapse * above / layer.temperature,
                                   -standard_hydrostatic_constant / layer.lapse);
}

/// Pressure altitude, m: the geopotential height at which the US Standard Atmosphere 1976 has the `pressure`,
/// hPa. Domain: 1776.8697 hPa (-5000 m) to 0.003734 hPa (84 852 m); outside it and for NaN, NaN.
inline double pressure_altitude(double pressure) {
  if (!(pressure > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  std::size_t number = 0;
  while (number + 1 < standard_layers.size() && pressure < standard_layers[number + 1].pressure) ++number;
  const StandardLayer& layer = standard_layers[number];
  const double logarithm = std::log(pressure / layer.pressure);
  const double height =
      layer.lapse == 0.0
          ? layer.base - layer.temperature / standard_hydrostatic_constant * logarithm
          : layer.base + layer.temperature / layer.lapse *
                             std::expm1(-layer.lapse / standard_hydrostatic_constant * logarithm);
  const bool inside = height >= standard_bottom && height <= standard_top;
  return inside ? height : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace pcor
