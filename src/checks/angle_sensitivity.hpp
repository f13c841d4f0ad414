#pragma once

#include <string>
#include <vector>

#include "checks/flown.hpp"

namespace pcor::internal {

/// Reference for the model's pressure in a manoeuvre that swings an angle.
enum class AngleReference {
  laser,         ///< delta-p from LAMS minus delta-p of the model
  height,        ///< pressure implied by GPS height and temperature, minus pressure of the model
  second_system  ///< static pressure of the second system minus static pressure of the model
};

std::string_view to_string(AngleReference witness);

/// Whether a flight has the reference.
bool has(const CheckedFlight& flight, AngleReference witness);

/// Result of a manoeuvre for an angle.
struct AngleSensitivity {
  Flown flown;
  std::vector<double> residual;  ///< residual at the records of the manoeuvre, hPa, minus its mean
  double swing = 0.0;            ///< standard deviation of the angle, deg
  double greatest = 0.0;         ///< largest absolute angle, deg
  Estimated slope{};             ///< slope of the residual, hPa/deg
  Estimated per_ratio{};         ///< slope against the ratio of the radome pressures, hPa; NaN: not recorded
  Estimated bend{};              ///< coefficient of the square of the angle, hPa/deg2; NaN if not fitted
  double scatter = 0.0;          ///< scatter of the residual about the fit, hPa

  /// Change of the residual from one end of the swing to the other, hPa.
  Estimated across() const;
};

/// Regression of the residual on the angle, with a constant and a drift in time, and with the square of the
/// angle if `with_square`. NaN if the manoeuvre has too few values. The series cover the flight.
AngleSensitivity sensitivity_of(const Flown& flown, AngleReference witness, const std::vector<double>& angle,
                                const std::vector<double>& ratio, bool with_square);

/// p(reference) - p(model) in a manoeuvre, hPa, at its records.
///
/// For the height: in air at rest the pressure falls by rho g for each metre, so the pressure of the model
/// implies the height -(R_a T/g0) ln(p/p_mean), with means over the manoeuvre. A GPS height above it is a
/// pressure of the model that is too high by rho g for each metre.
std::vector<double> residual_of(const Flown& flown, AngleReference witness);

/// Check of all manoeuvres of one kind.
struct AngleCheck {
  std::string name;   ///< name of the check
  std::string angle;  ///< title of the angle, for example "angle of attack"
  Regime regime;
  std::vector<AngleReference> witnesses;  ///< references in order of preference
  bool with_square = false;
  const std::vector<double>& (*angle_of)(const FlightAir& air);
  const std::vector<double>& (*ratio_of)(const FlightAir& air);
  std::string variables;  ///< variables of the angle, for messages
  std::string cannot_see;
};

CheckResult run_angle_check(const CheckedFlights& flights, const AngleCheck& check);

}  // namespace pcor::internal
