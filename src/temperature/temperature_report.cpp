#include <fmt/format.h>

#include <array>
#include <cmath>

#include <pcor/base/format_estimate.hpp>
#include <pcor/base/utc.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/temperature/temperature.hpp>
#include "base/phrasing.hpp"
#include "report/shown_flights.hpp"

namespace pcor {

using namespace internal;
namespace {

std::vector<double> joined(const TemperatureResult& result, std::vector<double> FlightHeights::*series) {
  std::vector<double> values;
  for (const FlightHeights& flight : result.flights)
    values.insert(values.end(), (flight.*series).begin(), (flight.*series).end());
  return values;
}

ReportTable coefficient_table(const TemperatureResult& result) {
  ReportTable table{
      "Coefficients",
      "T corrected = T + a0 + a1 t + a2 t², t in °C. The standard error comes from the curvature of the "
      "likelihood, averaged over likely noise models. Least squares on height, as in Cooper (2012), assumes "
      "independent heights and level or known isobars: its errors are too small. " +
          pressure_error_text(result) + ".",
      {"", result.pressure_error > 0.0 ? "likelihood ± std. error" : "likelihood ± std. error, noise only",
       "least squares ± std. error", "per 1 hPa of static pressure", "unit"},
      {}};
  for (std::size_t k = 0; k < result.likelihood.coefficients.size(); ++k) {
    const auto of = [k](const TemperatureFit& fit) {
      return format_estimate(fit.coefficients[k], fit.standard_errors[k]);
    };
    table.rows.push_back({fmt::format("a{}", k), of(result.likelihood), of(result.least_squares),
                          fmt::format("{:+.3g}", result.per_hpa[k]), coefficient_unit(k)});
  }
  return table;
}

ReportTable degree_table(const TemperatureResult& result) {
  ReportTable table{
      "Degree of the correction",
      "-2 ln L minus its value without correction: for all flights, and for each flight with the "
      "coefficients of the others. A coefficient is kept if it improves the prediction of held-out flights "
      "by more than 4 and by more than two standard errors.",
      {"correction", "all flights", "held-out flights", "std. error"},
      {}};
  const auto number = [](double x) { return std::isnan(x) ? std::string("-") : fmt::format("{:.1f}", x); };
  for (const DegreeChoice& choice : result.degrees)
    table.rows.push_back({degree_name(choice.degree), number(choice.deviance), number(choice.held_out),
                          number(choice.held_out_error)});
  return table;
}

ReportTable flight_table(const TemperatureResult& result) {
  ReportTable table{
      "Flights",
      "Rms of GPS height minus integral, about its mean in each segment and an estimate of the slope of "
      "isobars: the remainder with the correction is noise and the drift of the integral.",
      {"flight", "samples", "segments", "coldest, °C", "warmest, °C", "rms before, m", "rms after, m", ""},
      {}};
  for (const FlightHeights& flight : result.flights) {
    if (!flight.excluded.empty()) {
      table.rows.push_back({flight.flight, "", "", "", "", "", "", "excluded: " + flight.excluded});
      continue;
    }
    table.rows.push_back(
        {flight.flight, std::to_string(flight.samples), std::to_string(flight.segments),
         fmt::format("{:.1f}", flight.min_temperature), fmt::format("{:.1f}", flight.max_temperature),
         fmt::format("{:.2f}", flight.rms_before), fmt::format("{:.2f}", flight.rms_after), ""});
  }
  return table;
}

ReportTable part_table(const TemperatureResult& result) {
  ReportTable table{
      "Separate fits of parts",
      "Correction of each flight, of climbs and descents, and of the halves of the flights: the common "
      "correction plus a constant, with the error due to noise. If they differ significantly (p < 0.01), the "
      "standard deviation between them is included in the errors of the coefficients.",
      {"part", "at, °C", "separate fit, K", "std. error, K", "all data, K"},
      {}};
  for (const std::vector<PartCorrection>* parts : result.parts()) {
    for (const PartCorrection& part : *parts)
      table.rows.push_back({part.part, fmt::format("{:.1f}", part.temperature),
                            fmt::format("{:+.3f}", part.correction),
                            fmt::format("{:.2g}", part.standard_error), fmt::format("{:+.3f}", part.common)});
  }
  return table;
}

ReportTable law_table(const TemperatureResult& result) {
  ReportTable table{
      "Errors of the law",
      "Errors of the static-pressure coefficients estimated from heights, fitted with those of the "
      "temperature and corrected, with standard errors.",
      {"effect", "coefficient", "lacks", "unit", "range over the flights, hPa"},
      {}};
  for (const LawError& error : result.law_errors)
    table.rows.push_back({error.effect, error.parameter, format_estimate(error.change, error.standard_error),
                          std::string(effect_named(error.effect)->parameters[0].unit),
                          fmt::format("{:.2f}", error.range)});
  return table;
}

BarPanel correction_bars(const TemperatureResult& result) {
  BarPanel panel{
      "The correction",
      "Correction added to the temperature, with its standard error, over the range of the flights.",
      {},
      "correction",
      "K"};
  for (const TemperatureCorrection& at : result.corrections)
    panel.bars.push_back({fmt::format("{:.0f} °C", at.temperature), at.correction, at.standard_error});
  return panel;
}

}  // namespace

std::string degree_name(int degree) {
  constexpr std::array<const char*, 4> names{"none", "constant", "linear", "quadratic"};
  return names.at(static_cast<std::size_t>(degree) + 1);
}

std::string coefficient_unit(std::size_t power) {
  constexpr std::array<const char*, 3> units{"K", "1", "1/K"};
  return units.at(power);
}

std::string pressure_error_text(const TemperatureResult& result) {
  if (result.pressure_error > 0.0) {
    return fmt::format(
        "Standard errors include a constant error of the static pressure of {:.2g} hPa and an error of its "
        "law proportional to the pressure, {:.2g} hPa at the mean (--pressure-error sets both)",
        result.pressure_error, result.law_error);
  }
  constexpr double usual = 0.3;  // hPa, the rms of the memo's eq. 18
  std::string moved;
  for (std::size_t k = 0; k < result.per_hpa.size(); ++k) {
    moved += fmt::format("{}a{} by {:.2g}{}", k == 0 ? "" : ", ", k, std::abs(usual * result.per_hpa[k]),
                         k == 1 ? "" : " " + coefficient_unit(k));
  }
  return fmt::format(
      "Errors include noise only: a constant static-pressure bias of {:g} hPa in all flights would change "
      "{}; --pressure-error {:g} includes it",
      usual, moved, usual);
}

Report temperature_report(const TemperatureResult& result) {
  Report report;
  const TemperatureCorrection& middle = result.corrections[result.corrections.size() / 2];
  report.title = fmt::format("Temperature correction {} K at {:.0f} °C{}",
                             format_estimate(middle.correction, middle.standard_error, PlusSign::always, "±"),
                             middle.temperature, result.rejection_reason.empty() ? "" : ", not recommended");
  report.subtitle = "Calibration by the GPS height for " + result.model.model.name;
  if (!result.rejection_reason.empty())
    report.summary.push_back("Not recommended: " + result.rejection_reason + ".");
  for (const std::string& warning : result.warnings) report.summary.push_back("Warning: " + warning + ".");
  for (const Note& note : result.notes)
    report.summary.push_back(fmt::format("{}: {}.", label_of(note), note.text));
  report.info = {
      {"Samples", std::to_string(result.samples)},
      {"Noise of the GPS height", fmt::format("{:.2f} m in a sample, {:.2f} m correlated over {:.0f} s",
                                              result.gps_noise, result.gps_wander, result.gps_wander_time)},
      {"Drift of the hydrostatic height", fmt::format("{:.3f} m in a minute", result.drift)},
      {"Innovations", fmt::format("variance {:.2f} (1 for a correct noise model), correlation {:+.2f}",
                                  result.innovation_variance, result.innovation_correlation)}};

  for (const FlightHeights& flight : result.flights) {
    if (flight.time.empty()) continue;
    report.flight_starts.push_back(report.time.size());
    report.flight_names.push_back(flight.flight);
    report.time.insert(report.time.end(), flight.time.begin(), flight.time.end());
  }
  report.info.front().second += fmt::format(", shown as {} means of 10 s", report.time.size());
  report.columns = {
      {"before", "uncorrected", "m", joined(result, &FlightHeights::before)},
      {"after", "corrected", "m", joined(result, &FlightHeights::after)},
      {"height", "geopotential height by GPS", "m", joined(result, &FlightHeights::height)},
      {"temperature", "temperature", "°C", joined(result, &FlightHeights::temperature)},
      {"innovation", "innovation", "std. deviations", joined(result, &FlightHeights::innovation)}};
  show_flights_over_time(report);

  report.items.emplace_back(correction_bars(result));
  report.items.emplace_back(coefficient_table(result));
  report.items.emplace_back(TimePanel{
      "GPS height minus the integral of the hydrostatic equation",
      "Means over 10 s, about the mean of each segment, after subtraction of an estimated slope of isobars. "
      "A thermometer error makes the difference follow the height.",
      {"before", "after"},
      "height difference"});
  report.items.emplace_back(TimePanel{"Height", "Geopotential height by GPS.", {"height"}});
  report.items.emplace_back(BinnedPanel{
      "Normalised height errors (filter innovations)",
      "Innovations of the filter in standard deviations. A mean that varies with a variable indicates an "
      "error of the correction.",
      {"innovation"},
      {"temperature", "height"}});
  report.items.emplace_back(part_table(result));
  report.items.emplace_back(law_table(result));
  report.items.emplace_back(degree_table(result));
  report.items.emplace_back(flight_table(result));
  return report;
}

}  // namespace pcor
