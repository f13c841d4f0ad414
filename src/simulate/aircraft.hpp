#pragma once

#include <array>
#include <pcor/simulate/simulate.hpp>
#include <string_view>

namespace pcor::internal::simulate {

/// The differential ports of a radome: angle = offset + ratio (slope + slope_mach M), deg.
struct Radome {
  double offset;
  double slope;
  double slope_mach;

  /// The ratio of differential to dynamic pressure at an angle, deg.
  double ratio(double angle, double mach) const { return (angle - offset) / (slope + slope_mach * mach); }
  double angle(double ratio, double mach) const { return offset + ratio * (slope + slope_mach * mach); }
};

/// A thermometer in the airstream. Its recovery factor is c0 + c1 L + c2 L^2 + c3 L^3, L = log10 M.
struct Thermometer {
  std::string_view name;
  std::array<double, 4> recovery;

  /// The recovery factor at a Mach number above zero.
  double recovery_factor(double mach) const;
};

/// Properties of an aircraft. Sources: aircraft.cpp.
struct AircraftInfo {
  std::string_view type{};
  std::string_view registration{};
  Thermometer thermometer{};         ///< constant recovery factor, which a scenario may set
  Thermometer second_thermometer{};  ///< recovery factor used in processing since 2014

  double wing_area = 0.0;      ///< m2
  double lift_slope = 0.0;     ///< slope of the lift coefficient at low Mach number, 1/deg
  double zero_lift = 0.0;      ///< angle of attack without lift, flaps up, deg
  double flap_lift = 6.0;      ///< decrease of the zero-lift angle with full flaps, deg
  double drag_constant = 0.0;  ///< drag coefficient C_D = drag_constant + induced_drag C_L^2
  double induced_drag = 0.0;
  double weight = 0.0;              ///< initial weight, kg
  double fuel_flow = 0.0;           ///< kg/s
  double power = 0.0;               ///< total power of the engines at 100 %, after propeller losses, W
  double cabin_differential = 0.0;  ///< greatest, hPa

  double min_speed = 0.0;       ///< true airspeed of manoeuvres, m/s
  double max_speed = 0.0;       ///< m/s
  double lift_off_speed = 0.0;  ///< m/s
  double max_mach = 0.0;
  double max_attack = 12.0;      ///< before the stall, deg
  double ceiling = 0.0;          ///< m
  double climb_rate = 0.0;       ///< usual, m/s
  double speed_run_low = 0.0;    ///< usual, m/s
  double speed_run_high = 0.0;   ///< usual, m/s
  double speed_run_rate = 0.0;   ///< usual, m/s2
  double clear_above = 12000.0;  ///< height at which half of the laser's samples are missing, m

  Radome attack{};
  Radome sideslip{};
};

/// The facts of one of the two aircraft.
const AircraftInfo& info_of(Scenario::Aircraft aircraft);

/// The angle of attack, deg, at which the wing carries the weight:
///
///     alpha = alpha_0 + C_L (1 - M^2)^(1/2)/C_L_alpha,   C_L = weight load_factor g/(q_dyn S)
///
/// with the Prandtl-Glauert rule for compressibility. `dynamic_pressure` is rho v^2/2 in Pa, `flaps` in
/// percent, the load factor in units of standard gravity. Domain: M < 1.
double lift_attack(const AircraftInfo& aircraft, double weight, double load_factor, double dynamic_pressure,
                   double mach, double flaps);

/// Fraction of full power, %, required to fly at `speed` m/s with lift coefficient `lift`, while the aircraft
/// gains `energy_rate` (W) of height and speed; limited to 5 (idle) to 100.
double torque(const AircraftInfo& aircraft, double lift, double dynamic_pressure, double speed,
              double energy_rate);

}  // namespace pcor::internal::simulate
