#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "checks/circle_fit.hpp"
#include "checks/leg_pair.hpp"
#include "checks/manoeuvre_segment.hpp"

namespace pcor::internal {
namespace {

/// Tolerance as for the reverse heading, m/s.
constexpr double min_circle_error = 0.3;

/// A smaller turn cannot separate the wind from the airspeed.
constexpr double min_turn = 300.0;  // deg

/// Noise of one circle that its samples cannot show, m/s: the wind drifts during the circle. A quarter of the
/// change between the legs of a reverse heading, as in simulated air with all its drifts.
constexpr double wind_drift_of_circle = 0.25 * change_of_wind;

struct Circle {
  ManoeuvreSegment flown;
  CircleFit fit;
};

ReportTable table_of(const std::vector<Circle>& circles) {
  ReportTable table{
      "Circles",
      "Wind, error of the airspeed (too high positive) and error of the heading minus the sideslip, from the "
      "ground velocity around one turn. Errors exclude the drift of the wind.",
      {"circle", "turn, deg", "wind from, deg", "wind, m/s", "airspeed, m/s", "heading, deg", "rms, m/s"}};
  for (const auto& [flown, fit] : circles) {
    table.rows.push_back({flown.location(), fmt::format("{:+.0f}", fit.turned),
                          fmt::format("{:.0f}", direction_of(-fit.east_wind.value, -fit.north_wind.value)),
                          fmt::format("{:.1f}", std::hypot(fit.east_wind.value, fit.north_wind.value)),
                          format_number(fit.airspeed_error, ""), format_number(fit.heading_error, ""),
                          fmt::format("{:.2f}", fit.rms)});
  }
  return table;
}

}  // namespace

CheckResult check_circles(const CheckedFlights& flights) {
  if (const std::string missing = missing_for_tail_wind(flights); !missing.empty())
    return not_run("no flight " + missing);
  CheckResult result;
  std::vector<Circle> circles;
  for (ManoeuvreSegment& flown : segments_of_regime(flights, Regime::circle)) {
    const FlightAir& air = flown.flight->air;
    Circle circle{
        flown, fit_circle(flown.of(air.airspeed), flown.of(air.samples->motion.heading),
                          flown.of(air.east_speed), flown.of(air.north_speed), flown.time(), flown.step())};
    if (!std::isfinite(circle.fit.airspeed_error.value)) {
      result.notes.push_back(flown.location() + ": too few values in the circle");
    } else if (std::abs(circle.fit.turned) < min_turn) {
      result.notes.push_back(fmt::format("{}: usable turn of {:.0f} deg, at least {:.0f} deg required",
                                         flown.location(), std::abs(circle.fit.turned), min_turn));
    } else {
      circles.push_back(std::move(circle));
    }
  }
  if (circles.empty()) return regime_not_found(flights, Regime::circle, result.notes);
  std::vector<Estimate> errors;
  for (const Circle& circle : circles) {
    const Estimate& of_fit = circle.fit.airspeed_error;
    errors.push_back({of_fit.value, std::hypot(of_fit.error, wind_drift_of_circle)});
    result.bars.push_back({circle.flown.label() + (circle.fit.turned < 0.0 ? " left" : " right"),
                           errors.back().value, errors.back().error});
  }
  const Estimate error = combined(errors);
  const auto to_port = std::count_if(circles.begin(), circles.end(),
                                     [](const Circle& circle) { return circle.fit.turned < 0.0; });
  const auto sensitivity = [](const Circle& circle) {
    const FlightAir& air = circle.flown.flight->air;
    return pressure_per_airspeed(circle.flown.mean(air.pressure), circle.flown.mean(air.mach),
                                 circle.flown.mean(air.airspeed));
  };
  const Estimate hpa = mean_of(each_of(circles, sensitivity)) * error;
  set_verdict({test_statistic(error, min_circle_error, "m/s", "airspeed")}, result);
  result.finding = fmt::format(
      "From {} circle{}, {} to the left and {} to the right, the true airspeed is too {} by {:.2f} +- {:.2f} "
      "m/s, as if delta-p were off by {}.",
      circles.size(), circles.size() == 1 ? "" : "s", to_port,
      circles.size() - static_cast<std::size_t>(to_port), error.value < 0.0 ? "low" : "high",
      std::abs(error.value), error.error, format_number(hpa, "hPa"));
  result.limitations =
      "The check cannot separate errors of pressure, temperature and laser: it depends on the airspeed only, "
      "in a bank. Sideslip, an offset of the heading and the angle of attack times the bank are "
      "indistinguishable, and a wind that drifts during the turn appears as an error of the airspeed.";
  result.numbers = {{"circles", static_cast<double>(circles.size())}};
  add_number("airspeed_error", "_m_s", error, result);
  add_number("delta_p_error", "_hpa", hpa, result);
  result.tables = {table_of(circles)};
  result.columns = {
      column_in(flights, "circles left", "residual ground speed along the heading", "m/s", circles,
                [](const Circle& circle) { return circle.fit.along; }),
      column_in(flights, "circles heading", "heading", "deg", circles, [](const Circle& circle) {
        return circle.flown.of(circle.flown.flight->air.samples->motion.heading);
      })};
  return result;
}

}  // namespace pcor::internal
