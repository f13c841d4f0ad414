#include "checks/climb_layers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <pcor/base/utc.hpp>
#include "checks/manoeuvre_segment.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

/// Smallest relevant error of the thermometer, K: the typical error (memo, after eq. 22).
constexpr double min_thermometer_error = 0.3;

/// A line with a larger error at 0 degC, K, is not reported.
constexpr double max_useful_error = 1.0;

/// Finds the layers of a flight. @return the reason if the flight has no layer, otherwise an empty text
std::string find_layers_of(const FlightAir& air, FlightLayers& found) {
  if (air.temperature.empty())
    return "no thermometer is known; give a model (-m) with recovery_temperature "
           "or ambient_temperature in [variables]";
  if (std::string problem = height_problem(air); !problem.empty()) return problem;
  found = find_layers(air);
  if (!found.layers.empty()) return "";
  const LayerOptions options;
  return fmt::format(
      "there is no climb or descent of {:.0f} m at {:.0f} m/s or more without a gap in pressure, temperature "
      "or GPS height",
      options.min_thickness, options.min_climb_rate);
}

/// Adds the two tables and the bars.
void show_layers(const std::vector<FlightLayers>& flights, CheckResult& result) {
  ReportTable layers{
      "Layers",
      "T_p is the temperature from height and pressure, T_m the temperature of the thermometer; both are "
      "means over the height of the layer. The error applies to T_p.",
      {"flight", "start (UTC)", "end", "from, m", "to, m", "T_p, degC", "T_m, degC", "T_p - T_m, K",
       "error, K"}};
  ReportTable errors{
      "Sources of the error of a layer",
      "Standard errors of T_p, K. Noise affects only the two ends of a layer, because the steps between "
      "the ends cancel; it does not decrease with the number of samples.",
      {"flight", "start (UTC)", "GPS height", "pressure noise", "delta-p, constant", "delta-p, changing",
       "isobars"}};
  const auto kelvin = [](double value) { return fmt::format("{:.2f}", value); };
  const auto metres = [](double value) { return fmt::format("{:.0f}", value); };
  for (const FlightLayers& flight : flights) {
    for (const Layer& layer : flight.layers) {
      layers.rows.push_back({flight.flight, utc_text(layer.begin), utc_text(layer.end, "%H:%M:%S"),
                             metres(layer.height_begin), metres(layer.height_end),
                             kelvin(layer.hydrostatic_temperature() - constants::ice_point),
                             kelvin(layer.measured_temperature() - constants::ice_point),
                             fmt::format("{:+.2f}", layer.difference()), kelvin(layer.errors.total())});
      errors.rows.push_back({flight.flight, utc_text(layer.begin), kelvin(layer.errors.height_noise),
                             kelvin(layer.errors.pressure_noise), kelvin(layer.errors.static_bias),
                             kelvin(layer.errors.static_change), kelvin(layer.errors.gradient)});
      result.bars.push_back({fmt::format("{}, {:.0f} to {:.0f} m", utc_text(layer.begin, "%H:%M"),
                                         layer.height_begin, layer.height_end),
                             layer.difference(), layer.errors.total()});
    }
  }
  result.tables = {std::move(layers), std::move(errors)};
}

/// Adds a temperature of each layer, degC, at its records.
void add_column(const CheckedFlights& flights, const std::vector<FlightLayers>& all, const char* name,
                const char* title, double (Layer::*temperature)() const, CheckResult& result) {
  result.columns.push_back(column_of(flights, name, title, "degC", [&](const CheckedFlight& flight) {
    std::vector<double> values(flight.air.size(), nan);
    for (const Layer& layer : all[static_cast<std::size_t>(&flight - flights.data())].layers)
      std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(layer.first), layer.last - layer.first + 1,
                  (layer.*temperature)() - constants::ice_point);
    return values;
  }));
}

}  // namespace

CheckResult check_layers(const CheckedFlights& flights) {
  CheckResult result;
  std::vector<FlightLayers> all;
  for (const CheckedFlight& flight : flights) {
    FlightLayers found;
    const std::string reason = find_layers_of(flight.air, found);
    found.flight = flight.air.samples->name;
    if (!reason.empty()) result.notes.push_back(fmt::format("{}: {}", found.flight, reason));
    for (const Note& note : found.notes)
      result.notes.emplace_back(note.severity, fmt::format("{}: {}", found.flight, note.text));
    all.push_back(std::move(found));
  }
  const LayerFit fit = fit_layers(all);
  if (fit.layers == 0) return not_run(result.notes.front().text);  // the reason of the first flight

  std::vector<TestStatistic> numbers{test_statistic(fit.offset, min_thermometer_error, "K", "thermometer")};
  result.finding =
      fmt::format("Over {} layer{} the hydrostatic equation implies a thermometer correction of {}",
                  fit.layers, fit.layers == 1 ? "" : "s", format_number(fit.offset, "K"));
  std::vector<double> temperatures;
  for (const FlightLayers& flight : all) {
    for (const Layer& layer : flight.layers) temperatures.push_back(layer.measured_temperature());
  }
  const auto [coldest, warmest] = range_of(temperatures);
  const double range = warmest - coldest;
  const std::string span =
      fmt::format("{:.0f} to {:.0f} degC", coldest - constants::ice_point, warmest - constants::ice_point);
  const Estimate change = range * fit.c1;
  const Estimate at_freezing = fit.correction_at(constants::ice_point);
  if (std::isnan(fit.c1.value)) {
    result.finding += fmt::format(
        "; the layers are too few or too similar ({}) to determine a slope with temperature.", span);
  } else {
    // An uncertain slope leaves the verdict to the mean.
    TestStatistic over_range = test_statistic(change, min_thermometer_error, "K", "change from " + span);
    if (over_range.verdict == CheckVerdict::inconsistent) numbers.push_back(std::move(over_range));
    result.finding += at_freezing.error > max_useful_error
                          ? fmt::format("; its slope from {} is undetermined ({} per degree).", span,
                                        format_number(fit.c1, "K", 3))
                          : fmt::format("; as a line, {} at 0 degC and {} per degree.",
                                        format_number(at_freezing, "K"), format_number(fit.c1, "K", 4));
    result.notes.push_back(
        fmt::format("the form of Cooper (2012) is T_m + c0 + c1 T_m with absolute temperatures; c0 is {} "
                    "and c1 {}; their errors are almost fully correlated",
                    format_number(fit.correction_at(0.0), "K"), format_number(fit.c1, "K/K", 4)));
  }
  set_verdict(std::move(numbers), result);
  if (fit.error_scale > 1.0) {
    result.notes.push_back(
        fmt::format("the layers scatter {:.2f} times as much as their errors predict; the errors of the fit "
                    "were multiplied by this factor",
                    fit.error_scale));
  }
  result.limitations =
      "The check cannot separate errors of thermometer, pressure and height: an error of delta-p that grows "
      "with height, and isobars that slope along the track, look like a warmer or colder layer; a constant "
      "error of delta-p largely cancels between the ends of a layer (a few tenths of a kelvin for 1 hPa). An "
      "offset of the thermometer, a wrong recovery factor, heat of de-icing and neglected humidity are "
      "indistinguishable. A lag of a thermometer or a static line causes errors of opposite signs in climb "
      "and descent.";
  add_number("offset", "_k", fit.offset, result);
  add_number("offset_at_0_degc", "_k", at_freezing, result);
  add_number("slope", "", fit.c1, result);
  result.numbers.emplace_back("layers", static_cast<double>(fit.layers));
  if (!std::isnan(fit.c1.value)) add_number("change_over_range", "_k", change, result);
  show_layers(all, result);
  add_column(flights, all, "layers hydrostatic", "T_p, hydrostatic", &Layer::hydrostatic_temperature, result);
  add_column(flights, all, "layers measured", "T_m, thermometer", &Layer::measured_temperature, result);
  result.columns.push_back(
      column_of(flights, "layers d-value", "D-value", "m",
                [](const CheckedFlight& flight) { return masked(flight.air.d_value, flight.air.flying); }));
  return result;
}

}  // namespace pcor::internal
