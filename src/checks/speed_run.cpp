#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <pcor/physics/constants.hpp>
#include <pcor/physics/geodesy.hpp>
#include "checks/leg_pair.hpp"
#include "checks/manoeuvre_segment.hpp"

namespace pcor::internal {
namespace {

/// Smallest relevant error of delta-p from the slow to the fast end of a run, hPa.
constexpr double min_run_change = 0.3;

/// Changes between the slow and the fast end of a run that are too slow for its samples to show as noise: the
/// wind on the scale of a run, m/s, half the change between the legs of a reverse heading; and the error of a
/// GPS height, m, at least the error of differential GPS. Neither is below the scatter about the line.
/// Simulated flights show drifts of this size.
constexpr double wind_drift_of_run = 0.5 * change_of_wind;
constexpr double min_drift_of_height = 0.15;
constexpr double drift_in_scatter = 1.0;

/// Dependence of a series on the airspeed in a run.
struct Trend {
  double scatter = 0.0;       ///< standard deviation
  double range = 0.0;         ///< maximum minus minimum
  Estimate slope{};           ///< slope per m/s of airspeed, fitted with a drift in time
  Estimate pressure_error{};  ///< error of delta-p at the fast end if correct at the slow end, hPa
};

struct SpeedRun {
  ManoeuvreSegment flown;
  double airspeed_range = 0.0;  ///< m/s
  Estimate dynamic_slope{};     ///< slope of DVALUE, m per hPa of dynamic pressure
  Trend height;                 ///< DVALUE, m
  Trend wind;                   ///< UXW, m/s
};

/// @param values of the series at the samples of the run
/// @param fitted values for the slope, from which a known part may be subtracted
/// @param per_unit error of delta-p for one unit of the series, hPa
/// @param min_drift of the series from end to end that its samples do not show as noise
Trend trend_of(const std::vector<double>& values, const std::vector<double>& fitted,
               const ManoeuvreSegment& flown, double airspeed_range, double per_unit, double min_drift) {
  Trend trend;
  trend.scatter = standard_deviation(values);
  const auto [minimum, maximum] = range_of(values);
  trend.range = maximum - minimum;
  const LeastSquares line = flown.regression(fitted, {flown.of(flown.flight->air.airspeed)});
  trend.slope = line.coefficients[2];
  const double across = airspeed_range * per_unit;
  const double drift = std::max(min_drift, drift_in_scatter * line.rms);
  trend.pressure_error = {across * trend.slope.value,
                          std::hypot(across * trend.slope.error, per_unit * drift)};
  return trend;
}

/// GPS height above the height that the pressure of the model implies in air of the temperature of the run,
/// m. The D-value assumes the standard temperature, so a climb changes it without an error of the pressure.
/// @param scale height in which the pressure falls by a factor e, m  @param pressure mean of the run, hPa
std::vector<double> height_above_pressure(const ManoeuvreSegment& flown, bool is_missing, double scale,
                                          double pressure) {
  const FlightAir& air = flown.flight->air;
  std::vector<double> height = flown.of(is_missing ? std::vector<double>() : air.geopotential_height);
  const std::vector<double> pressures = flown.of(air.pressure);
  for (std::size_t i = 0; i < height.size(); ++i) height[i] += scale * std::log(pressures[i] / pressure);
  return height;
}

SpeedRun run_of(const ManoeuvreSegment& flown) {
  const FlightAir& air = flown.flight->air;
  SpeedRun run;
  run.flown = flown;
  const auto [slow, fast] = range_of(flown.of(air.airspeed));
  run.airspeed_range = fast - slow;
  const double pressure = flown.mean(air.pressure);
  const double scale =
      flown.mean(air.gas_constant) * flown.mean(air.temperature) / constants::standard_gravity;  // m
  const bool has_height = height_problem(air).empty() && !air.d_value.empty();
  const std::vector<double> d_value = flown.of(has_height ? air.d_value : std::vector<double>{});
  run.height = trend_of(d_value, height_above_pressure(flown, !has_height, scale, pressure), flown,
                        run.airspeed_range, pressure / scale, min_drift_of_height);
  run.dynamic_slope = flown.regression(d_value, {flown.of(air.dynamic)}).coefficients[2];
  // The tail wind is too low if the airspeed is too high.
  const std::vector<double> tail_wind = flown.of(air.tail_wind);
  run.wind = trend_of(tail_wind, tail_wind, flown, run.airspeed_range,
                      -pressure_per_airspeed(pressure, flown.mean(air.mach), flown.mean(air.airspeed)),
                      wind_drift_of_run);
  return run;
}

bool known(const Trend& trend) { return std::isfinite(trend.slope.value); }

/// Height and wind are blind to different errors, so one inconsistent result is enough; otherwise the more
/// accurate one decides.
Estimate decisive(const Estimate& height, const Estimate& wind) {
  for (const Estimate& each : {height, wind}) {
    if (classify(each, min_run_change) == CheckVerdict::inconsistent) return each;
  }
  return !(height.error <= wind.error) && std::isfinite(wind.error) ? wind : height;
}

/// @param digits of the scatter and the range; slopes have two more
ReportTable table_of(const std::vector<SpeedRun>& runs, Trend SpeedRun::*trend, const char* title,
                     const char* caption, const std::string& unit, int digits) {
  const bool is_height = trend == &SpeedRun::height;
  ReportTable table{title,
                    caption,
                    {"run", "airspeed, m/s", "sd, " + unit, "range, " + unit, "slope, " + unit + " per m/s"}};
  if (is_height) table.headers.emplace_back("slope, m per hPa of q");
  table.headers.emplace_back("delta-p, hPa");
  for (const SpeedRun& run : runs) {
    const Trend& of_run = run.*trend;
    if (!known(of_run)) continue;
    std::vector<std::string> row{run.flown.location(), fmt::format("{:.0f}", run.airspeed_range),
                                 fmt::format("{:.{}f}", of_run.scatter, digits),
                                 fmt::format("{:.{}f}", of_run.range, digits),
                                 format_number(of_run.slope, "", digits + 2)};
    if (is_height) row.push_back(format_number(run.dynamic_slope, "", digits + 2));
    row.push_back(format_number(of_run.pressure_error, ""));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

CheckResult check_speed_run(const CheckedFlights& flights) {
  if (std::none_of(flights.begin(), flights.end(),
                   [](const CheckedFlight& flight) { return !flight.air.airspeed.empty(); }))
    return not_run("no flight " + missing_for_tail_wind(flights));
  const std::vector<ManoeuvreSegment> flown = segments_of_regime(flights, Regime::speed_run);
  if (flown.empty()) return regime_not_found(flights, Regime::speed_run);
  std::vector<SpeedRun> runs;
  for (const ManoeuvreSegment& each : flown) {
    SpeedRun run = run_of(each);
    if (known(run.height) || known(run.wind)) runs.push_back(std::move(run));
  }
  if (runs.empty()) {
    const std::string wind = missing_for_tail_wind(flights);
    return not_run(fmt::format("the speed runs have neither a DVALUE ({}) nor a tail wind{}",
                               height_problem(flown.front().flight->air),
                               wind.empty() ? "" : " (no flight " + wind + ")"));
  }
  CheckResult result;
  const Estimate height =
      combined(each_of(runs, [](const SpeedRun& run) { return run.height.pressure_error; }));
  const Estimate wind = combined(each_of(runs, [](const SpeedRun& run) { return run.wind.pressure_error; }));
  const bool has_height = std::isfinite(height.value);
  const bool has_wind = std::isfinite(wind.value);
  const Estimate across = decisive(height, wind);
  set_verdict({test_statistic(across, min_run_change, "hPa", "change from slow to fast")}, result);
  const auto average = [&](Trend SpeedRun::*trend, double Trend::*number) {
    return mean_of(each_of(runs, [=](const SpeedRun& run) { return run.*trend.*number; }));
  };
  result.finding = fmt::format("Over {} speed run{}", runs.size(), runs.size() == 1 ? "" : "s");
  if (has_height) {
    result.finding += fmt::format(
        " DVALUE scatters by {:.1f} m and varies with the airspeed as if delta-p were off by {} from the "
        "slow to the fast end",
        average(&SpeedRun::height, &Trend::scatter), format_number(height, "hPa"));
  } else {
    result.notes.push_back("DVALUE not used: " + height_problem(runs.front().flown.flight->air));
  }
  if (has_wind) {
    result.finding += fmt::format(
        "{} the tail wind scatters by {:.2f} m/s, over a range of {:.1f} m/s, and varies with the airspeed "
        "as if delta-p were off by {}",
        has_height ? ";" : "", average(&SpeedRun::wind, &Trend::scatter),
        average(&SpeedRun::wind, &Trend::range), format_number(wind, "hPa"));
  } else {
    result.notes.push_back("the tail wind is not used: no flight " + missing_for_tail_wind(flights));
  }
  result.finding += ".";
  result.limitations =
      "The check does not detect errors that are constant over the speed, such as an offset of a transducer, "
      "and cannot separate angle of attack, thrust and dynamic pressure, which change together in these "
      "runs.";
  result.numbers = {{"runs", static_cast<double>(runs.size())},
                    {"d_value_sd_m", average(&SpeedRun::height, &Trend::scatter)},
                    {"d_value_range_m", average(&SpeedRun::height, &Trend::range)},
                    {"tail_wind_sd_m_s", average(&SpeedRun::wind, &Trend::scatter)},
                    {"tail_wind_range_m_s", average(&SpeedRun::wind, &Trend::range)}};
  add_number("delta_p_across", "_hpa", height, result);
  add_number("delta_p_across_from_wind", "_hpa", wind, result);
  result.tables = {
      table_of(runs, &SpeedRun::height, "DVALUE in speed runs",
               "Scatter and range of DVALUE (GPS height minus pressure altitude), its slopes against the "
               "airspeed and the dynamic pressure fitted with a drift in time, and the error of delta-p from "
               "the slow to the fast end that the first slope implies.",
               "m", 1),
      table_of(runs, &SpeedRun::wind, "Tail wind in speed runs",
               "Scatter and range of the tail wind, its slope against the airspeed fitted with a drift in "
               "time, and the error of delta-p from the slow to the fast end that it implies.",
               "m/s", 2)};
  result.tables.erase(std::remove_if(result.tables.begin(), result.tables.end(),
                                     [](const ReportTable& table) { return table.rows.empty(); }),
                      result.tables.end());
  const auto column = [&](const char* name, const char* title, const char* unit,
                          std::vector<double> FlightAir::*series, bool is_departure) {
    result.columns.push_back(column_in(flights, name, title, unit, runs, [=](const SpeedRun& run) {
      const std::vector<double> values = run.flown.of(run.flown.flight->air.*series);
      return is_departure ? subtract_mean(values) : values;
    }));
  };
  column("speed-run airspeed", "true airspeed", "m/s", &FlightAir::airspeed, false);
  column("speed-run height", "DVALUE minus its mean", "m", &FlightAir::d_value, true);
  column("speed-run wind", "Tail wind minus its mean", "m/s", &FlightAir::tail_wind, true);
  return result;
}

}  // namespace pcor::internal
