#include "checks/angle_sensitivity.hpp"

namespace pcor::internal {

CheckResult check_pitch(const CheckedFlights& flights) {
  AngleCheck check;
  check.name = "pitch";
  check.angle = "angle of attack";
  check.regime = Regime::pitch_manoeuvre;
  check.witnesses = {AngleReference::laser, AngleReference::height, AngleReference::second_system};
  check.angle_of = attack_of;
  check.ratio_of = [](const FlightAir& air) -> const std::vector<double>& { return air.attack_ratio; };
  check.variables = "ATTACK or AKRD; [variables] attack names another";
  check.cannot_see =
      "The check cannot separate the angle of attack from quantities that vary with it in a pitch manoeuvre: "
      "the load factor, and with a lag the pressure change as the aircraft rises and sinks. An error of the "
      "elevation of the laser's beam also looks like a slope.";
  return run_angle_check(flights, check);
}

}  // namespace pcor::internal
