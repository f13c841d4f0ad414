#pragma once

#include <pcor/simulate/simulate.hpp>
#include <vector>

namespace pcor::internal::simulate {

inline constexpr double pascal_per_hpa = 100.0;

/// The physics of moist air on the truth side, written independently of pcor/physics: a mixture of dry air
/// and vapour by their mass fractions.

/// A parcel of air at rest relative to the aircraft's surroundings.
struct Air {
  double pressure = 0.0;        ///< hPa
  double temperature = 0.0;     ///< K
  double vapor_pressure = 0.0;  ///< hPa
};

/// Gas constant, J/(kg K): the mean of those of dry air and vapour by mass.
double gas_constant(const Air& air);

/// Density, kg/m3.
double density(const Air& air);

/// Speed of sound, m/s: (c_p/c_v R T)^(1/2).
double speed_of_sound(const Air& air);

/// Total pressure, hPa, of air with the speed `speed` (m/s), without losses: p (T*/T)^(c_p/R) with T* = T +
/// v^2/(2 c_p).
double total_pressure(const Air& air, double speed);

/// Temperature, K, of the air brought to rest with the part `recovery` of its heating.
double recovery_temperature(const Air& air, double speed, double recovery);

/// Mach number, 1, computed by a dry-air computer from a pair of pressures of one unit; 0 if the dynamic one
/// is not positive.
double dry_mach(double static_pressure, double dynamic_pressure);

/// Saturation vapour pressure over water, hPa, temperature in K: Alduchov and Eskridge, J. Appl. Meteorol.
/// 35, 601-609 (1996), eq. 21, 0.4 % from 233 to 323 K. Its inverse is exact.
double saturation_pressure(double temperature);

/// The dew point over water, K, of a vapour pressure in hPa above zero.
double dew_point(double vapor_pressure);

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
