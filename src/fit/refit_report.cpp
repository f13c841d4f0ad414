#include <pcor/fit/refit_report.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/phrasing.hpp"
#include "compare/comparison_panels.hpp"
#include "fit/fit_pictures.hpp"
#include "fit/fitted_model.hpp"

namespace pcor {

using namespace internal;

namespace {

/// Sentence on a held-out flight, without the values before the fit if these are unknown.
std::string held_out_text(const FlightFit& flight) {
  const auto before = [&flight](double value, const char* word) {
    return std::isnan(flight.before.rms) ? "" : fmt::format("{:.3f} {} ", value, word);
  };
  return fmt::format("Held out, {}: rms {}{:.3f} hPa after the fit, scatter {}{:.3f} hPa.", flight.flight,
                     before(flight.before.rms, "before and"), flight.after.rms,
                     before(flight.before.scatter(), "and"), flight.after.scatter());
}

ReportTable coefficient_table(const RefitResult& fit) {
  ReportTable table;
  table.title = "Coefficients";
  table.caption =
      "Std. error: from correlated noise, the misfit of the model and the calibration of the reference; "
      "jackknife: from leaving out one flight or one part of a flight at a time (inf: one alone determines "
      "the coefficient). Unit 1: a ratio, such as hPa/hPa.";
  table.headers = {"coefficient", "before", "after", "std. error", "jackknife", "unit", "stage"};
  if (fit.is_by_gps()) {
    table.caption =
        "Likelihood: standard error by the likelihood of the GPS references; jackknife: from leaving out one "
        "flight or one part of a flight at a time (inf: one alone determines the coefficient). Stated error: "
        "the larger one for each combination of coefficients; a combination that the flights do not "
        "determine adds its error before the fit. Unit 1: a ratio, such as hPa/hPa.";
    table.headers[3] = "stated error";
    table.headers.insert(table.headers.begin() + 4, "likelihood");
  }
  const auto number = [](double error) { return std::isnan(error) ? "" : fmt::format("{:.2g}", error); };
  for (const FittedParameter& p : fit.parameters) {
    const bool has_error = p.fitted && p.standard_error > 0.0 && std::isfinite(p.standard_error);
    std::vector<std::string> row{p.name, fmt::format("{:.6g}", p.start),
                                 has_error
                                     ? fmt::format("{:.{}f}", p.value, decimals_of_error(p.standard_error))
                                     : fmt::format("{:.6g}", p.value),
                                 !p.fitted    ? "fixed"
                                 : p.at_bound ? "bound"
                                              : number(p.standard_error)};
    if (fit.is_by_gps()) row.push_back(number(p.noise_error));
    row.insert(row.end(), {number(p.jackknife_error), p.unit.empty() ? "see formula" : p.unit,
                           p.fitted ? std::to_string(p.stage) : ""});
    table.rows.push_back(std::move(row));
  }
  return table;
}

ReportTable correlation_table(const RefitResult& fit) {
  ReportTable table;
  table.title = "Correlations of the coefficients";
  table.caption = fmt::format("Condition number {:.0f} (above 300: coefficients are nearly collinear).",
                              fit.condition_number);
  table.headers.emplace_back("");
  std::vector<std::size_t> fitted;
  for (std::size_t i = 0; i < fit.covariance_names.size(); ++i) {
    const std::string& name = fit.covariance_names[i];
    if (std::any_of(fit.parameters.begin(), fit.parameters.end(),
                    [&name](const FittedParameter& p) { return p.fitted && p.name == name; })) {
      fitted.push_back(i);
      table.headers.push_back(name);
    }
  }
  for (const std::size_t a : fitted) {
    std::vector<std::string> row{fit.covariance_names[a]};
    for (const std::size_t b : fitted) {
      const double scale = std::sqrt(fit.covariance[a][a] * fit.covariance[b][b]);
      row.push_back(scale > 0.0 ? fmt::format("{:+.3f}", fit.covariance[a][b] / scale) : "");
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

ReportTable flight_table(const RefitResult& fit) {
  ReportTable table;
  table.title = "Flights before and after";
  table.caption = "Held-out flights or parts were not used in the fit.";
  table.headers = {"flight",
                   "part",
                   "samples",
                   "rms before, hPa",
                   "rms after, hPa",
                   "bias after, hPa",
                   "scatter after, hPa",
                   std::string(fit.noise_label()) + ", hPa"};
  for (const FlightFit& flight : fit.flights) {
    table.rows.push_back({flight.flight, flight.holdout ? "held out" : "fitted",
                          std::to_string(flight.after.samples), fmt::format("{:.3f}", flight.before.rms),
                          fmt::format("{:.3f}", flight.after.rms), fmt::format("{:+.3f}", flight.after.bias),
                          fmt::format("{:.3f}", flight.after.scatter()),
                          fmt::format("{:.3f}", flight.after.noise_rms)});
  }
  return table;
}

}  // namespace

Report refit_report(const RefitResult& fit, const Comparison& comparison) {
  ComparisonPanels panels(comparison);
  Report& report = panels.report();
  const std::string before = fmt::format("{:.3f}", fit.rms_before), after = fmt::format("{:.3f}", fit.rms);
  const std::string change = std::isnan(fit.rms_before) ? "gives an rms residual of"
                             : before == after          ? "does not change the rms residual of"
                                                        : "changes the rms residual from " + before + " to";
  report.title = fmt::format(
      "The refit {} {} hPa; {} {:.3f} hPa{}", change, after, fit.noise_label(), fit.noise_rms,
      fit.defect_error > 0.0 ? fmt::format("; standard error of delta-p {:.2f} hPa", fit.defect_error) : "");
  report.subtitle = fmt::format("Refit of {} to {}", unfitted_name(fit.model), fit.reference_text);
  summarise_held_out(report, fit.flights);
  for (const std::string& warning : fit.warnings) report.summary.push_back(sentence(warning));
  if (const std::string text = flaps_out_text(fit.flaps_out, "the fit"); !text.empty())
    report.summary.push_back(sentence(text));
  for (const FlightFit& flight : fit.flights) {
    if (flight.holdout) report.summary.push_back(held_out_text(flight));
  }
  for (const Note& note : fit.notes) {
    const bool is_reported =
        std::find(comparison.notes.begin(), comparison.notes.end(), note) != comparison.notes.end();
    if (!is_reported) report.summary.push_back(sentence(format_note(note)));
  }
  panels.summarise();
  if (auto picture = coefficient_picture(fit.parameters, "before the fit", "after the fit"))
    report.items.emplace_back(std::move(*picture));
  add_held_out(report, fit.flights);
  panels.add_panels();
  panels.add_pairs();
  if (fit.omissions.size() > 1) {
    BarPanel bars;
    bars.title = "Contribution of each effect";
    bars.caption = "Rms residual with one effect removed and the others refitted.";
    bars.bars.push_back({"all effects", fit.rms, 0.0});
    for (const Omission& omission : fit.omissions)
      bars.bars.push_back({"without " + omission.effect, omission.rms, 0.0});
    bars.axis = "rms";
    bars.unit = "hPa";
    report.items.emplace_back(std::move(bars));
  }
  report.items.emplace_back(flight_table(fit));
  if (ReportTable table = correlation_table(fit); table.rows.size() > 1)
    report.items.emplace_back(std::move(table));
  panels.add_tables();
  // After the first picture.
  report.items.emplace(report.items.begin() + 1, coefficient_table(fit));
  return std::move(report);
}

}  // namespace pcor
