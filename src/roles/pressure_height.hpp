#pragma once

#include <limits>
#include <string>
#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// The result of comparing a height with the pressures of its flight.
struct HeightEvidence {
  enum class Kind {
    gps,                ///< it departs from the heights of all static pressures as a geometric height does
    undecided,          ///< it is close to one of them, and the flight cannot decide
    pressure_altitude,  ///< it is the height of one of them in the standard atmosphere
  };
  Kind kind = Kind::gps;
  std::string pressure{};  ///< the closest static pressure; empty without a static pressure
  double bias = 0.0;       ///< hPa, the median of the pressure of the height less that pressure
  double scatter = 0.0;    ///< hPa, about the median, robust
  /// Change of the height with the pressure altitude of the first pressure: within 20 % of 1 in real air. NaN
  /// if a fifth of the flight is not 300 m above another fifth.
  double slope = std::numeric_limits<double>::quiet_NaN();

  /// Why no atmosphere has this slope, and what to do, for the height of a variable; empty if it is possible.
  std::string slope_problem(const std::string& variable) const;
};

/// Compares a height with one static pressure by the standard atmosphere. A pressure altitude agrees to the
/// resolution of both, within 1 hPa in the mean; a height of GPS departs by the weather, about 5 to 12 hPa.
/// @param height m  @param pressure hPa
HeightEvidence compare_height(const std::vector<double>& height, const std::vector<double>& pressure);

/// A recorded static pressure and the unit that model or aircraft state; empty for the unit in the file.
struct StatedPressure {
  std::string variable{};
  std::string unit{};
};

/// Compares a height with several static pressures; returns the comparison that is closest, with the slope
/// for the first pressure.
HeightEvidence height_evidence(const Flight& flight, const std::vector<double>& height,
                               const std::vector<StatedPressure>& pressures);

/// The static pressures of a flight: the model's, and those of the pairs that its aircraft's names have.
std::vector<StatedPressure> static_pressures_of(const Flight& flight, const ModelDefinition& model);

/// "the pressure of the height is that of PSXC within 0.01 hPa (mean +0.00 hPa)".
std::string to_string(const HeightEvidence& evidence);

}  // namespace pcor::internal
