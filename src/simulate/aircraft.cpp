#include "simulate/aircraft.hpp"

#include <algorithm>
#include <cmath>

#include <pcor/physics/geodesy.hpp>

namespace pcor::internal::simulate {
namespace {

// Recovery factors: NCAR nimbus; Cooper, Recovery factor study, NCAR, 2014 (unheated Rosemount, heated
// HARCO). Wing area, Mach limit, cabin: manufacturer's data. Radomes: NCAR processing algorithms sec. 4.5.
// Envelope: speeds and heights of research flights (memo, QAtools). Drag, power, fuel flow, flaps: estimates.

AircraftInfo make(Scenario::Aircraft aircraft) {
  const bool is_c130 = aircraft == Scenario::Aircraft::c130;
  AircraftInfo a;
  a.type = is_c130 ? "C-130" : "GV";
  a.registration = is_c130 ? "N130AR" : "N677F";
  const auto choose = [is_c130](double c130, double gv) { return is_c130 ? c130 : gv; };
  a.wing_area = choose(162.1, 105.6);
  // The next two are fitted: C-130 to the angles of the memo's envelope at 56 t, GV to 2.5 deg in cruise.
  a.lift_slope = choose(0.0905, 0.085);
  a.zero_lift = choose(-4.3, -0.4);
  a.drag_constant = choose(0.035, 0.018);
  a.induced_drag = choose(0.045, 0.050);
  a.weight = choose(58000.0, 36000.0);
  a.fuel_flow = choose(0.6, 0.36);
  a.power = choose(11.0e6, 18.0e6);
  a.cabin_differential = choose(517.0, 701.0);  // 7.5 psi, 10.17 psi
  a.min_speed = choose(75.0, 110.0);
  a.max_speed = choose(155.0, 260.0);
  a.lift_off_speed = choose(65.0, 75.0);
  a.max_mach = choose(0.62, 0.885);
  a.ceiling = choose(9000.0, 15000.0);
  a.climb_rate = choose(5.0, 8.0);
  a.speed_run_low = choose(98.0, 158.0);
  a.speed_run_high = choose(150.0, 225.0);
  a.speed_run_rate = choose(0.25, 0.35);
  if (is_c130) {
    a.thermometer = {"TTRR", {0.95, 0.0, 0.0, 0.0}};
    a.second_thermometer = {"RTF1", {0.9959, 0.0283, 0.0374, 0.0762}};
    a.attack = {5.776, 15.031, 0.0};
    a.sideslip = {-0.012004, 12.2115, 0.0};
  } else {
    a.thermometer = {"TTHR1", {0.985, 0.0, 0.0, 0.0}};
    a.second_thermometer = {"RTH1", {0.988, 0.053, 0.090, 0.091}};
    a.attack = {5.5156, 19.07, 2.08};
    a.sideslip = {-0.052888, 21.15507, 0.0};
  }
  return a;
}

}  // namespace

double Thermometer::recovery_factor(double mach) const {
  const auto& c = recovery;
  if (c[1] == 0.0 && c[2] == 0.0 && c[3] == 0.0) return c[0];
  const double logarithm = std::log10(mach);
  return c[0] + logarithm * (c[1] + logarithm * (c[2] + logarithm * c[3]));
}

const AircraftInfo& info_of(Scenario::Aircraft aircraft) {
  static const AircraftInfo c130 = make(Scenario::Aircraft::c130);
  static const AircraftInfo gv = make(Scenario::Aircraft::gv);
  return aircraft == Scenario::Aircraft::c130 ? c130 : gv;
}

double lift_attack(const AircraftInfo& aircraft, double weight, double load_factor, double dynamic_pressure,
                   double mach, double flaps) {
  const double lift =
      weight * load_factor * constants::standard_gravity / (dynamic_pressure * aircraft.wing_area);
  const double zero_lift = aircraft.zero_lift - 0.01 * flaps * aircraft.flap_lift;
  return zero_lift + lift * std::sqrt(1.0 - mach * mach) / aircraft.lift_slope;
}

double torque(const AircraftInfo& aircraft, double lift, double dynamic_pressure, double speed,
              double energy_rate) {
  const double drag =
      dynamic_pressure * aircraft.wing_area * (aircraft.drag_constant + aircraft.induced_drag * lift * lift);
  return std::clamp(100.0 * (drag * speed + energy_rate) / aircraft.power, 5.0, 100.0);
}

}  // namespace pcor::internal::simulate
