#pragma once

#include <pcor/simulate/simulate.hpp>
#include <vector>

#include "simulate/air.hpp"

namespace pcor::internal::simulate {

/// Gravity, m/s2, at a latitude (deg) and height (m): Somigliana's formula of WGS 84, falling with height as
/// the ellipsoid's field does to second order. Accuracy 1e-7 up to 20 km.
double gravity(double latitude, double height);

/// The column of air over a place: hydrostatic balance of moist air, integrated upwards from the ground.
///
/// The temperature falls by the lapse rate from the ground to the tropopause and is constant above it; the
/// inversion adds its strength over 200 m. The relative humidity goes from its lower to its upper value in
/// the inversion and to 2 % at the tropopause.
class Column {
 public:
  /// @throws Error if the air would be colder than 150 K below the tropopause.
  Column(const Scenario::Atmosphere& atmosphere, double latitude);

  /// Air at a height, m. The last value is used beyond the column (500 m below the ground to 18 km).
  Air at(double height) const;

 private:
  double bottom_;
  std::vector<double> log_pressure_;
  std::vector<Air> levels_;
};

/// Dissipation rate of turbulence, m2/s3, at a height in m: the boundary-layer value up to the inversion, the
/// free-troposphere value from 300 m above it, their geometric interpolation in between.
double dissipation(const Scenario::Atmosphere& atmosphere, double height);

}  // namespace pcor::internal::simulate
