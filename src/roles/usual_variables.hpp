#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <pcor/model/quantity.hpp>
#include <pcor/physics/recovery_factor.hpp>

namespace pcor::internal {

/// A series that flights usually record, and the variables that hold it in NCAR's files.
struct UsualVariables {
  QuantityFacts series;            ///< its name, the unit that it is converted to, and which way is positive
  std::vector<std::string> names;  ///< the likeliest first
  /// True where several instruments measure it, so that the choice is a part of the model: its files name it,
  /// and these variables only stand in where there is no model.
  bool chosen_by_model = false;
};

/// The usual variables of the series of that name: of a role, or of one of those that have none,
/// "other_altitude", "longitude", "ground_speed_east" and "ground_speed_north".
/// @throws std::out_of_range if there is no such series.
const UsualVariables& usual_series(std::string_view name);

/// The names of the usual variables of a role. Empty for the roles that a model must name itself: pressures,
/// temperatures, humidity, the laser, the Mach number.
std::vector<std::string> usual_variables(Quantity role);

/// All heights, that of GPS before those of inertial systems and of the pressure, which do to tell a climb
/// from a descent.
std::vector<std::string> usual_heights();

/// The variables of a pair of pressures, hPa.
struct PressurePair {
  std::string static_pressure;
  std::string dynamic_pressure;

  /// "PSFD/QCF".
  std::string name() const { return static_pressure + "/" + dynamic_pressure; }
};

/// The pairs that NCAR's aircraft measure: PSFD/QCF, PSFRD/QCFR, PSF/QCF, PS_A/QC_A.
const std::vector<PressurePair>& measured_pressures();

/// The pairs that the flight's own processing chose and corrected, or chose alone: PSXC/QCXC, PSX/QCX.
const std::vector<PressurePair>& processed_pressures();

/// A recovery temperature, and the law of its thermometer.
struct Thermometer {
  std::string variable;
  std::string_view recovery;  ///< one of `published_recovery_factors`
};

/// The thermometers that stand in where no model names one, the likeliest first. The Rosemounts of the C-130,
/// and the reference TTX or RTX, which may be any, have 0.95, as in NCAR's processing; the fast RTF1 that of
/// the unheated Rosemounts, 2014; the heated HARCOs of the GV that of 2022, which is between those of their
/// two elements; the heated TTWH 0.98.
const std::vector<Thermometer>& usual_thermometers();

}  // namespace pcor::internal
