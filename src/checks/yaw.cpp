#include "checks/angle_sensitivity.hpp"

namespace pcor::internal {

CheckResult check_yaw(const CheckedFlights& flights) {
  AngleCheck check;
  check.name = "yaw";
  check.angle = "sideslip";
  check.regime = Regime::yaw_manoeuvre;
  check.witnesses = {AngleReference::laser, AngleReference::second_system, AngleReference::height};
  check.with_square = true;
  check.angle_of = sideslip_of;
  check.ratio_of = [](const FlightAir& air) -> const std::vector<double>& { return air.sideslip_ratio; };
  check.variables = "SSLIP or SSRD; [variables] sideslip names another";
  check.cannot_see =
      "The check cannot separate an error of the azimuth of the laser's beam, which looks like a slope, and "
      "an offset of the sideslip, which contributes to the slope and the square. It does not detect errors "
      "common to both static systems.";
  return run_angle_check(flights, check);
}

}  // namespace pcor::internal
