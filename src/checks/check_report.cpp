#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <pcor/base/utc.hpp>
#include <pcor/checks/check.hpp>
#include "base/phrasing.hpp"
#include "numerics/missing.hpp"
#include "report/columns.hpp"
#include "report/shown_flights.hpp"

namespace pcor {

using namespace internal;

namespace {

/// Converts "total-pressure" to the heading "Total pressure".
std::string heading(std::string name) {
  if (name == "lams-temperature") return "LAMS temperature";
  std::replace(name.begin(), name.end(), '-', ' ');
  name.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
  return name;
}

/// Picture of a check. Names of columns are without the name of the check.
struct Figure {
  enum class Kind { bars, over_time, against, pair };

  std::string_view check;
  Kind kind;
  const char* title;
  const char* caption;
  const char* axis = "";    ///< label of the axis of bars and lines over time
  const char* unit = "";    ///< unit of bars
  const char* first = "";   ///< column, vertical
  const char* second = "";  ///< column, horizontal; over time a second line
  double autocorrelation_time = 1.0;
};

constexpr const char* angle_caption =
    "Static pressure implied by the manoeuvre minus static pressure of the model. A slope indicates a wrong "
    "or missing term of the model.";

constexpr Figure figures[] = {
    {"total-pressure", Figure::Kind::pair, "Total pressures of the two systems",
     "Static defects cancel in the total pressure: the difference shows errors of the transducers, the "
     "pitots and the lines.",
     "", "", "two", "one"},
    {"static-pressure", Figure::Kind::pair, "Static pressures of the two systems",
     "The line is an orthogonal fit.", "", "", "two", "one"},
    {"reverse-heading", Figure::Kind::bars, "Error of the airspeed from each reverse heading",
     "Airspeed minus that of the headings; error bars include the typical change of the wind between two "
     "legs.",
     "error of the airspeed", "m/s"},
    {"reverse-heading", Figure::Kind::over_time, "Tail wind on the legs",
     "Wind along the aircraft's axis. It has opposite signs on the two legs of a pair; an error of the "
     "airspeed has the same sign.",
     "", "", "tail wind"},
    {"circles", Figure::Kind::bars, "Error of the airspeed from each circle",
     "Airspeed minus that of the circle; error bars include the typical drift of the wind during a circle.",
     "error of the airspeed", "m/s"},
    {"circles", Figure::Kind::against, "Residual of the circle fit",
     "Ground speed along the heading minus wind, airspeed and its error. A wave over the heading indicates a "
     "wind that changed during the circle.",
     "", "", "left", "heading", 5.0},
    {"speed-run", Figure::Kind::against, "DVALUE minus its mean in speed runs",
     "A pressure error that depends on the speed causes a slope; sloping isobars cause a drift.", "", "",
     "height", "airspeed", 10.0},
    {"speed-run", Figure::Kind::against, "Tail wind minus its mean in speed runs",
     "The wind is independent of the airspeed: a slope is an error of the airspeed.", "", "", "wind",
     "airspeed", 10.0},
    {"pitch", Figure::Kind::against, "Residual against the angle of attack in pitch manoeuvres",
     angle_caption, "", "", "residual", "angle", 3.0},
    {"yaw", Figure::Kind::against, "Residual against the sideslip in yaw manoeuvres", angle_caption, "", "",
     "residual", "angle", 3.0},
    {"layers", Figure::Kind::bars, "Correction required by the thermometer",
     "T_p - T_m of every layer. Errors are correlated: neighbouring layers of a climb share one end, "
     "and layers of a flight share the slope of the isobars.",
     "T_p - T_m", "K"},
    {"layers", Figure::Kind::over_time, "Temperature of the layers", "One line over each layer.",
     "temperature", "", "hydrostatic", "measured"},
    {"layers", Figure::Kind::over_time, "D-value",
     "Geopotential height minus pressure altitude. In level flight its slope is the slope of the isobars "
     "along the track; in a climb it follows the temperature of the air.",
     "", "", "d-value"},
    {"lams-temperature", Figure::Kind::over_time, "Temperature from the laser and from the thermometer",
     "ATLAMS from the pressures of the model, and the thermometer (Cooper 2012, figure 3).", "temperature",
     "", "laser", "thermometer"},
    {"lams-temperature", Figure::Kind::against, "The difference against altitude",
     "ATLAMS minus the thermometer: a slope is an error of one of them.", "", "", "difference", "altitude",
     10.0},
    {"lams-temperature", Figure::Kind::bars, "Noise of the difference by period",
     "Noise of means over half the period. Below 3 s the air at the laser's volume differs from the air at "
     "the pitot tube.",
     "noise", "K"},
    {"spectrum", Figure::Kind::bars, "Power by period",
     "Rms in octaves of the period. For white noise the bars fall by the square root of two from one octave "
     "to the next longer one; for turbulence they grow.",
     "rms", "hPa"},
    {"spectrum", Figure::Kind::over_time, "Analysed series", "The series of the spectrum in time.", "", "",
     "series"}};

/// Adds the pictures of a check that have values.
void add_figures(const CheckResult& result, Report& report) {
  using Kind = Figure::Kind;
  for (const Figure& figure : figures) {
    if (figure.check != result.name) continue;
    const std::string first = result.name + " " + figure.first;
    const std::string second = result.name + " " + figure.second;
    if (figure.kind == Kind::bars) {
      if (std::any_of(result.bars.begin(), result.bars.end(),
                      [](const ReportBar& bar) { return std::isfinite(bar.value); }))
        report.items.emplace_back(
            BarPanel{figure.title, figure.caption, result.bars, figure.axis, figure.unit});
    } else if (figure.kind == Kind::over_time) {
      add_if_present(report, TimePanel{figure.title, figure.caption, {first, second}, figure.axis});
    } else if (!meet(report.columns, {first, second})) {
      continue;
    } else if (figure.kind == Kind::against) {
      BinnedPanel panel{figure.title, figure.caption, {first}, {second}};
      panel.autocorrelation_time = figure.autocorrelation_time;
      report.items.emplace_back(std::move(panel));
    } else {
      const ReportLine fitted{result.number("orthogonal_slope"), result.number("orthogonal_offset_hpa"),
                              "fitted line"};
      report.items.emplace_back(
          PairPanel{figure.title, figure.caption, second, first, {{1.0, 0.0, "equal"}, fitted}});
    }
  }
}

ReportTable verdicts(const Checks& checks) {
  ReportTable table{
      "Verdicts",
      "Inconsistent: larger than the tolerance and than three standard errors. Consistent: within the "
      "tolerance by two standard errors. Otherwise the check is inconclusive.",
      {"check", "verdict", "number", "tolerance", "result"}};
  for (const CheckResult& result : checks.results) {
    if (!result.was_run) {
      table.rows.push_back({heading(result.name), "not run", "", "", sentence(result.reason)});
      continue;
    }
    const TestStatistic& key = result.key;
    table.rows.push_back(
        {heading(result.name), std::string(to_string(result.verdict)),
         fmt::format("{:+.3f} ± {:.3f} {}, {}", key.value, key.standard_error, key.unit, key.what),
         fmt::format("{:g} {}", key.tolerance, key.unit), sentence(result.finding)});
  }
  return table;
}

/// Deciding number of each check, in units of its tolerance, with its verdict.
DotPanel forest(const Checks& checks) {
  DotPanel panel{
      "Checks at a glance",
      "Deciding number of each check divided by its tolerance; the bar is one standard error, the verdict "
      "uses two or three. A square in the band is consistent, a cross inconsistent, an open square "
      "inconclusive.",
      {""},
      {},
      "number / tolerance"};
  panel.band = "negligible";
  for (const CheckResult& result : checks.results) {
    const TestStatistic& key = result.key;
    if (!result.was_run || !(key.tolerance > 0.0) || !std::isfinite(key.value)) continue;
    const bool is_known = std::isfinite(key.standard_error);
    const double error = is_known ? key.standard_error : 0.0;
    const ReportTone tone = result.verdict == CheckVerdict::consistent     ? ReportTone::good
                            : result.verdict == CheckVerdict::inconsistent ? ReportTone::bad
                                                                           : ReportTone::open;
    panel.rows.push_back({heading(result.name),
                          {{key.value / key.tolerance, error / key.tolerance}},
                          is_known ? fmt::format("{:+.3f} ± {:.3f} {}", key.value, error, key.unit)
                                   : fmt::format("{:+.3f} {}, error unknown", key.value, key.unit),
                          tone});
  }
  return panel;
}

ReportTable numbers_of(const CheckResult& result) {
  ReportTable table{heading(result.name) + ": numbers",
                    "Names as in the JSON result, with the unit at the end of each name.",
                    {"number", "value", "number", "value", "number", "value"}};
  for (const auto& [name, value] : result.numbers) {
    if (!std::isfinite(value)) continue;
    if (table.rows.empty() || table.rows.back().size() == table.headers.size()) table.rows.emplace_back();
    table.rows.back().push_back(name);
    table.rows.back().push_back(fmt::format("{:.5g}", value));
  }
  if (!table.rows.empty()) table.rows.back().resize(table.headers.size());
  table.is_folded = true;
  return table;
}

/// Checks that ran, by their verdict.
std::map<CheckVerdict, std::vector<const CheckResult*>> by_verdict(const Checks& checks) {
  std::map<CheckVerdict, std::vector<const CheckResult*>> found;
  for (const CheckResult& result : checks.results) {
    if (result.was_run) found[result.verdict].push_back(&result);
  }
  return found;
}

}  // namespace

std::string summary_of(const Checks& checks) {
  auto found = by_verdict(checks);
  const auto& inconsistent = found[CheckVerdict::inconsistent];
  const auto& inconclusive = found[CheckVerdict::inconclusive];
  const std::size_t consistent = found[CheckVerdict::consistent].size();
  const std::size_t run_count = consistent + inconclusive.size() + inconsistent.size();
  std::vector<std::string> names;
  for (const CheckResult* const result : inconsistent) names.push_back(result->name);
  if (!names.empty())
    return fmt::format("{} of {} checks inconsistent: {}", names.size(), run_count, fmt::join(names, ", "));
  if (consistent > 0) {
    return fmt::format("No check contradicts the {}{}", checks.has_model ? "model" : "pressures",
                       inconclusive.empty()
                           ? ""
                           : fmt::format("; {} of {} checks inconclusive", inconclusive.size(), run_count));
  }
  for (const CheckResult* const result : inconclusive) {
    const TestStatistic& key = result->key;
    names.push_back(
        fmt::format("{} {:+.3f} +- {:.3f} {}", result->name, key.value, key.standard_error, key.unit));
  }
  return fmt::format("Nothing is decided: {}{} not run",
                     names.empty() ? "" : fmt::format("{} inconclusive, ", fmt::join(names, ", ")),
                     checks.results.size() - run_count);
}

Report check_report(const Checks& checks) {
  Report report = checks.pictures;
  auto found = by_verdict(checks);
  const std::size_t inconsistent = found[CheckVerdict::inconsistent].size();
  const std::size_t consistent = found[CheckVerdict::consistent].size();
  const std::size_t inconclusive = found[CheckVerdict::inconclusive].size();
  for (const CheckResult* const result : found[CheckVerdict::inconsistent])
    report.summary.push_back(heading(result->name) + ": " + sentence(result->finding));
  report.title = summary_of(checks);
  report.subtitle = "Independent checks" + (checks.model.empty() ? "" : " of " + checks.model);
  report.summary.insert(
      report.summary.begin(),
      fmt::format("{} checks, {} with sufficient data: {} consistent, {} inconsistent, {} inconclusive.",
                  checks.results.size(), inconsistent + consistent + inconclusive, consistent, inconsistent,
                  inconclusive));
  for (const CheckResult& result : checks.results)
    report.columns.insert(report.columns.end(), result.columns.begin(), result.columns.end());
  show_flights_over_time(report);
  report.columns.erase(std::remove_if(report.columns.begin(), report.columns.end(),
                                      [](const ReportColumn& column) { return !has_value(column.values); }),
                       report.columns.end());
  const std::vector<std::size_t> bounds = flight_bounds(report);
  for (std::size_t i = 0; i < report.flight_names.size(); ++i) {
    report.info.emplace_back(
        "Flight", fmt::format("{}, {} to {} UTC", report.flight_names[i], utc_text(report.time[bounds[i]]),
                              utc_text(report.time[bounds[i + 1] - 1], "%H:%M:%S")));
  }
  if (report.flight_names.size() < checks.flights.size())
    report.info.emplace_back("All flights", fmt::format("{}", fmt::join(checks.flights, ", ")));
  report.info.emplace_back("Program", "pcor " PCOR_VERSION);
  for (const Note& note : checks.notes) report.info.emplace_back(label_of(note), note.text);
  if (DotPanel picture = forest(checks); !picture.rows.empty()) report.items.emplace_back(std::move(picture));
  report.items.emplace_back(verdicts(checks));
  for (const CheckResult& result : checks.results) {
    if (!result.was_run) continue;
    ReportText text;
    text.title = fmt::format("{}: {}", heading(result.name), to_string(result.verdict));
    text.paragraphs = {fmt::format("Decided by this number: {}.", result.explanation),
                       sentence(result.finding), "Limitations: " + result.limitations};
    for (const Note& note : result.notes) text.paragraphs.push_back(sentence(format_note(note)));
    report.items.emplace_back(std::move(text));
    add_figures(result, report);
    for (const ReportTable& table : result.tables) {
      if (!table.rows.empty()) report.items.emplace_back(table);
    }
    if (ReportTable numbers = numbers_of(result); !numbers.rows.empty())
      report.items.emplace_back(std::move(numbers));
  }
  return report;
}

}  // namespace pcor
