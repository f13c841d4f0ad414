#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <pcor/physics/constants.hpp>
#include <pcor/physics/geodesy.hpp>
#include "base/phrasing.hpp"
#include "checks/manoeuvre_segment.hpp"

namespace pcor::internal {
namespace {

/// Smallest relevant change of the residual over the swing of an angle, hPa.
constexpr double min_swing_change = 0.3;

/// Peak-to-peak range of a sine in standard deviations.
const double ends_of_sine = 2.0 * std::sqrt(2.0);

/// Reference for the model's pressure in a manoeuvre that swings an angle.
struct AngleReference {
  const char* name;
  /// p(reference) - p(model) at the records of a manoeuvre, hPa; empty if its flight lacks the reference.
  std::vector<double> (*residual)(const ManoeuvreSegment& flown);
};

std::vector<double> from_laser(const ManoeuvreSegment& flown) {
  const FlightAir& air = flown.flight->air;
  if (!air.laser || !has_value(air.laser->static_defect)) return {};
  return difference(flown.of(air.laser->static_defect), flown.of(air.static_defect));
}

/// In air at rest the pressure falls by rho g for each metre, so the pressure of the model implies the height
/// -(R_a T/g0) ln(p/p_mean), with means over the manoeuvre. A GPS height above it is a pressure of the model
/// that is too high by rho g for each metre.
std::vector<double> from_height(const ManoeuvreSegment& flown) {
  const FlightAir& air = flown.flight->air;
  if (!has_value(air.geopotential_height) || !has_value(air.temperature) || !height_problem(air).empty())
    return {};
  const std::vector<double> pressure = flown.of(air.pressure);
  std::vector<double> residual = flown.of(air.geopotential_height);
  const double scale =
      flown.mean(air.gas_constant) * flown.mean(air.temperature) / constants::standard_gravity;  // m
  const double mean_pressure = mean_of(pressure);
  const double mean_height = mean_of(residual);
  for (std::size_t i = 0; i < residual.size(); ++i) {
    const double height = mean_height - scale * std::log(pressure[i] / mean_pressure);
    residual[i] = -pressure[i] / scale * (residual[i] - height);
  }
  return residual;
}

std::vector<double> from_second_system(const ManoeuvreSegment& flown) {
  const CheckedFlight& flight = *flown.flight;
  if (!flight.second || !has_value(flight.second->pressure)) return {};
  return difference(flown.of(flight.second->pressure), flown.of(flight.air.pressure));
}

constexpr AngleReference laser{"LAMS", from_laser};
constexpr AngleReference gps_height{"GPS height", from_height};
constexpr AngleReference other_system{"second system", from_second_system};

/// Result of a manoeuvre for an angle.
struct AngleSensitivity {
  ManoeuvreSegment flown;
  AngleReference reference{};
  std::vector<double> residual;  ///< residual at the records of the manoeuvre, hPa, minus its mean
  double swing = 0.0;            ///< standard deviation of the angle, deg
  double maximum = 0.0;          ///< largest absolute angle, deg
  Estimate slope{};              ///< slope of the residual, hPa/deg
  Estimate per_ratio{nan, nan};  ///< slope against the ratio of the radome pressures, hPa; NaN: not recorded
  Estimate bend{nan, nan};       ///< coefficient of the square of the angle, hPa/deg2; NaN if not fitted
  double scatter = 0.0;          ///< scatter of the residual about the fit, hPa

  /// Change of the residual from one end of the swing to the other, hPa.
  Estimate across() const { return ends_of_sine * swing * slope; }
};

/// Check of all manoeuvres of one kind.
struct AngleCheck {
  const char* name;   ///< name of the check
  const char* angle;  ///< title of the angle, for example "angle of attack"
  Regime regime;
  std::vector<AngleReference> references;  ///< the preferred one first
  bool with_square;
  std::vector<double> FlightAir::*by_model;
  std::vector<double> FlightMotion::*recorded;
  std::vector<double> FlightAir::*ratio;
  const char* variables;  ///< variables of the angle, for messages
  const char* limitations;

  /// Angle of a flight, deg: from the model, otherwise as recorded; empty if it has neither.
  const std::vector<double>& angle_of(const FlightAir& air) const {
    return (air.*by_model).empty() ? air.samples->motion.*recorded : air.*by_model;
  }
};

/// Regression of the residual on the angle, with a constant and a drift in time, and with the square of the
/// angle if the check has it. NaN if the manoeuvre has too few values.
AngleSensitivity sensitivity_of(const ManoeuvreSegment& flown, const AngleReference& reference,
                                const std::vector<double>& residual, const AngleCheck& check) {
  const FlightAir& air = flown.flight->air;
  const std::vector<double> angles = flown.of(check.angle_of(air));
  AngleSensitivity result{flown, reference, subtract_mean(residual), standard_deviation(angles)};
  std::vector<std::vector<double>> columns{angles};
  if (check.with_square) columns.push_back(squares_of(angles));
  const LeastSquares against_angle = flown.regression(residual, columns);
  result.slope = against_angle.coefficients[2];
  result.scatter = against_angle.rms;
  if (check.with_square) result.bend = against_angle.coefficients[3];
  for (const double each : angles) result.maximum = std::fmax(result.maximum, std::abs(each));
  if (!(air.*check.ratio).empty())
    result.per_ratio = flown.regression(residual, {flown.of(air.*check.ratio)}).coefficients[2];
  return result;
}

/// Names of the references that manoeuvres used, the first one first: "LAMS and GPS height".
std::string references_of(const std::vector<AngleSensitivity>& manoeuvres) {
  std::vector<std::string> names;
  for (const AngleSensitivity& each : manoeuvres) {
    if (std::find(names.begin(), names.end(), each.reference.name) == names.end())
      names.emplace_back(each.reference.name);
  }
  return join_list(names);
}

ReportTable table_of(const std::vector<AngleSensitivity>& manoeuvres, const AngleCheck& check) {
  ReportTable table{
      fmt::format("Each {}", info_of(check.regime).name),
      fmt::format("Slope of the residual against the {}, fitted with a drift in time, and its effect from "
                  "one end of the swing to the other.",
                  check.angle),
      {"manoeuvre", "compared with", "swing, deg", "slope, hPa/deg"}};
  const bool with_ratio = std::any_of(manoeuvres.begin(), manoeuvres.end(),
                                      [](const auto& each) { return std::isfinite(each.per_ratio.value); });
  if (with_ratio) table.headers.emplace_back("per ratio, hPa");
  if (check.with_square) table.headers.emplace_back("square, hPa/deg2");
  table.headers.insert(table.headers.end(), {"across, hPa", "scatter, hPa"});
  for (const AngleSensitivity& each : manoeuvres) {
    std::vector<std::string> row{each.flown.location(), each.reference.name,
                                 fmt::format("{:.1f}", 0.5 * ends_of_sine * each.swing),
                                 format_number(each.slope, "", 3)};
    if (with_ratio)
      row.push_back(std::isfinite(each.per_ratio.value) ? format_number(each.per_ratio, "", 1)
                                                        : "not recorded");
    if (check.with_square) row.push_back(format_number(each.bend, "", 4));
    row.insert(row.end(), {format_number(each.across(), ""), fmt::format("{:.2f}", each.scatter)});
    table.rows.push_back(std::move(row));
  }
  return table;
}

CheckResult run_angle_check(const CheckedFlights& flights, const AngleCheck& check) {
  const bool has_angle = std::any_of(flights.begin(), flights.end(), [&](const CheckedFlight& flight) {
    return has_value(check.angle_of(flight.air));
  });
  if (!has_angle) return not_run(fmt::format("no flight has the {} ({})", check.angle, check.variables));
  const std::vector<ManoeuvreSegment> flown = segments_of_regime(flights, check.regime);
  if (flown.empty()) return regime_not_found(flights, check.regime);
  CheckResult result;
  std::vector<AngleSensitivity> manoeuvres;
  bool has_reference = false;
  for (const ManoeuvreSegment& each : flown) {
    bool has_too_few = false;
    for (const AngleReference& reference : check.references) {
      const std::vector<double> residual = reference.residual(each);
      if (residual.empty()) continue;
      has_reference = true;
      AngleSensitivity one = sensitivity_of(each, reference, residual, check);
      has_too_few = !std::isfinite(one.slope.value);
      if (has_too_few) continue;
      manoeuvres.push_back(std::move(one));
      break;
    }
    if (has_too_few) result.notes.push_back(each.location() + ": too few values in this manoeuvre");
  }
  if (!has_reference) {
    const std::string height = height_problem(flown.front().flight->air);
    return not_run(
        fmt::format("a {} was flown, but no reference is available: no laser (lams_airspeed), no second "
                    "static system (--reference static:OTHER.toml) and no GPS height with a temperature{}",
                    info_of(check.regime).name, height.empty() ? "" : " (" + height + ")"));
  }
  if (manoeuvres.empty()) return regime_not_found(flights, check.regime, result.notes);
  const auto swing = [](const AngleSensitivity& each) { return ends_of_sine * each.swing; };
  const auto square = [](const AngleSensitivity& each) { return each.maximum * each.maximum; };
  const Estimate slope = combined(each_of(manoeuvres, &AngleSensitivity::slope));
  const Estimate bend = combined(each_of(manoeuvres, &AngleSensitivity::bend));
  const Estimate across = mean_of(each_of(manoeuvres, swing)) * slope;
  const Estimate bent = mean_of(each_of(manoeuvres, square)) * bend;
  std::vector<TestStatistic> numbers{
      test_statistic(across, min_swing_change, "hPa", "change across the swing")};
  result.finding = fmt::format(
      "Over {} {}{} the residual against {} changes by {} of {}, {} from one end of the swing to the other.",
      manoeuvres.size(), info_of(check.regime).name, manoeuvres.size() == 1 ? "" : "s",
      references_of(manoeuvres), format_number(slope, "hPa/deg", 3), check.angle,
      format_number(across, "hPa"));
  if (check.with_square) {
    numbers.push_back(
        test_statistic(bent, min_swing_change, "hPa", "quadratic part at the end of the swing"));
    result.finding += fmt::format(" With its square the residual changes by {}, {} at the end of the swing.",
                                  format_number(bend, "hPa/deg2", 4), format_number(bent, "hPa"));
  }
  set_verdict(std::move(numbers), result);
  const auto uncorrected =
      std::find_if(manoeuvres.begin(), manoeuvres.end(), [](const AngleSensitivity& each) {
        return each.reference.residual == from_second_system && !each.flown.flight->second_corrected;
      });
  if (uncorrected != manoeuvres.end()) {
    if (result.verdict == CheckVerdict::inconsistent)
      mark_inconclusive("the second system is uncorrected, and the slope may be its error", result);
    result.notes.push_back(
        fmt::format("{} is uncorrected, and the slope may be its error; --reference static:OTHER.toml gives "
                    "its correction",
                    uncorrected->flown.flight->second_name));
  }
  result.limitations = check.limitations;
  result.numbers = {{"manoeuvres", static_cast<double>(manoeuvres.size())}};
  add_number("slope", "_hpa_deg", slope, result);
  add_number("across", "_hpa", across, result);
  const Estimate ratio = combined(each_of(manoeuvres, &AngleSensitivity::per_ratio));
  if (std::isfinite(ratio.value)) add_number("per_ratio", "_hpa", ratio, result);
  if (check.with_square) {
    add_number("square", "_hpa_deg2", bend, result);
    add_number("square_at_end", "_hpa", bent, result);
  }
  result.tables = {table_of(manoeuvres, check)};
  const std::string name = check.name;
  result.columns = {
      column_in(flights, name + " residual", "residual minus its mean", "hPa", manoeuvres,
                [](const AngleSensitivity& each) { return each.residual; }),
      column_in(flights, name + " angle", check.angle, "deg", manoeuvres, [&](const AngleSensitivity& each) {
        return each.flown.of(check.angle_of(each.flown.flight->air));
      })};
  return result;
}

}  // namespace

CheckResult check_pitch(const CheckedFlights& flights) {
  return run_angle_check(
      flights,
      {"pitch",
       "angle of attack",
       Regime::pitch_manoeuvre,
       {laser, gps_height, other_system},
       false,
       &FlightAir::attack,
       &FlightMotion::attack,
       &FlightAir::attack_ratio,
       "ATTACK or AKRD; [variables] attack names another",
       "The check cannot separate the angle of attack from quantities that vary with it in a pitch "
       "manoeuvre: the load factor, and with a lag the pressure change as the aircraft rises and sinks. An "
       "error of the elevation of the laser's beam also looks like a slope."});
}

CheckResult check_yaw(const CheckedFlights& flights) {
  return run_angle_check(
      flights,
      {"yaw",
       "sideslip",
       Regime::yaw_manoeuvre,
       {laser, other_system, gps_height},
       true,
       &FlightAir::sideslip,
       &FlightMotion::sideslip,
       &FlightAir::sideslip_ratio,
       "SSLIP or SSRD; [variables] sideslip names another",
       "The check cannot separate an error of the azimuth of the laser's beam, which looks like a slope, and "
       "an offset of the sideslip, which contributes to the slope and the square. It does not detect errors "
       "common to both static systems."});
}

}  // namespace pcor::internal
