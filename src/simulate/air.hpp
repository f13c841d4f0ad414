#pragma once

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

/// Specific heat at constant pressure, J/(kg K): 7/2 R_d and 4 R_w by mass.
double specific_heat(const Air& air);

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

}  // namespace pcor::internal::simulate
