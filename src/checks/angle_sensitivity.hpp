#pragma once

#include <string>
#include <vector>

#include "checks/flown.hpp"

namespace pcor::internal {

/// What the model's pressure is held against in a manoeuvre that swings an angle.
enum class AngleReference {
  laser,         ///< delta-p from LAMS less that of the model
  height,        ///< the pressure that GPS height and temperature ask for, less that of the model
  second_system  ///< the static pressure of the second system less that of the model
};

std::string_view to_string(AngleReference witness);

/// Whether a flight has the witness.
bool has(const CheckedFlight& flight, AngleReference witness);

/// What a manoeuvre says of an angle.
struct AngleSensitivity {
  Flown flown;
  std::vector<double> residual;  ///< at the records of the manoeuvre, hPa, less its mean
  double swing = 0.0;            ///< standard deviation of the angle, deg
  double greatest = 0.0;         ///< largest angle either way, deg
  Estimated slope{};             ///< of the residual, hPa/deg
  Estimated per_ratio{};  ///< the same against the ratio of the radome pressures, hPa; NaN: not recorded
  Estimated bend{};       ///< with the square of the angle, hPa/deg2; NaN where not asked for
  double scatter = 0.0;   ///< of the residual about the fit, hPa

  /// What the slope makes from one end of the swing to the other, hPa.
  Estimated across() const;
};

/// Regression of the residual on the angle, with a constant and a drift in time, and with the square of the
/// angle where `with_square`. NaN where the manoeuvre has too few values. Series are those of the flight.
AngleSensitivity sensitivity_of(const Flown& flown, AngleReference witness, const std::vector<double>& angle,
                                const std::vector<double>& ratio, bool with_square);

/// p(witness) - p(model) in a manoeuvre, hPa, at its records.
///
/// Of the height: in air at rest the pressure falls by rho g for each metre, so the pressure of the model
/// asks for the height -(R_a T/g0) ln(p/p_mean), with means over the manoeuvre, and what the GPS height is
/// more than that is a pressure of the model that is too high by rho g for each metre.
std::vector<double> residual_of(const Flown& flown, AngleReference witness);

/// A check of all manoeuvres of one kind.
struct AngleCheck {
  std::string name;   ///< of the check
  std::string angle;  ///< for example "angle of attack"
  Regime regime;
  std::vector<AngleReference> witnesses;  ///< the one to be preferred first
  bool with_square = false;
  const std::vector<double>& (*angle_of)(const FlightAir& air);
  const std::vector<double>& (*ratio_of)(const FlightAir& air);
  std::string variables;  ///< of the angle, for messages
  std::string cannot_see;
};

CheckResult run_angle_check(const CheckedFlights& flights, const AngleCheck& check);

}  // namespace pcor::internal
