#pragma once

/// Physical constants, each with its unit and source.
namespace pcor::constants {

/// Universal gas constant, J/(kmol K). CODATA 2018 (exact).
inline constexpr double universal_gas_constant = 8314.462618;

/// Molar mass of dry air, kg/kmol. US Standard Atmosphere 1976 composition with present carbon dioxide;
/// the value of NCAR's processing.
inline constexpr double molar_mass_dry_air = 28.9637;

/// Molar mass of water, kg/kmol. IAPWS R6-95; the value of NCAR's processing.
inline constexpr double molar_mass_water = 18.0153;

/// Gas constant of dry air, R_d, J/(kg K): 287.0649.
inline constexpr double gas_constant_dry_air = universal_gas_constant / molar_mass_dry_air;

/// Gas constant of water vapour, R_w, J/(kg K): 461.5223.
inline constexpr double gas_constant_water_vapor = universal_gas_constant / molar_mass_water;

/// Ratio of the molar masses of water and dry air, epsilon, 1: 0.62200. Memo eq. 13.
inline constexpr double molar_mass_ratio = molar_mass_water / molar_mass_dry_air;

/// Specific heat of dry air at constant volume, J/(kg K): 5/2 R_d, a diatomic gas. Memo before eq. 15.
inline constexpr double specific_heat_volume_dry_air = 2.5 * gas_constant_dry_air;

/// Specific heat of dry air at constant pressure, J/(kg K): 7/2 R_d. Memo eq. 16.
inline constexpr double specific_heat_pressure_dry_air = 3.5 * gas_constant_dry_air;

/// Standard gravity, m/s2: what turns a geopotential into a height. 3rd CGPM (1901), WMO-No. 8.
inline constexpr double standard_gravity = 9.80665;

/// The ice point, K. Definition of the Celsius scale.
inline constexpr double ice_point = 273.15;

/// Radians in a degree.
inline constexpr double radians_per_degree = 0.017453292519943295769;

}  // namespace pcor::constants
