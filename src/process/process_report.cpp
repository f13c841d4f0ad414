#include <pcor/process/process_report.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include <pcor/base/atomic_file.hpp>
#include <pcor/base/error.hpp>
#include <pcor/flight/flight.hpp>
#include "base/phrasing.hpp"
#include "report/columns.hpp"
#include "residuals/samples.hpp"
#include "roles/recorded_series.hpp"
#include "roles/usual_variables.hpp"

namespace pcor {

using namespace internal;

namespace {

using Series = std::vector<double>;

// Indices in the columns of `Outputs`.
constexpr std::size_t delta_column = 0;
constexpr std::size_t static_column = 2;
constexpr std::size_t dynamic_column = 3;

constexpr const char* difference_from_original = "own_difference";

/// Static pressure corrected in the flight file, hPa; empty if absent.
RecordedSeries original_static_pressure(const Flight& input) {
  const VariableNaming& naming = naming_of(input);
  RecordedSeries original{processed_static_pressure(input, naming)};
  if (original.variable.empty()) return original;
  original.values =
      read_values(input, original.variable,
                  input.conversion(original.variable, "hPa", "", naming.unit_of(original.variable)))
          .values;
  return original;
}

/// Records with extended flaps; nullopt if unknown.
std::optional<std::vector<bool>> flaps_of(const Flight& input, const ModelDefinition& model) {
  try {
    return flaps_extended(input, model);
  } catch (const Error&) {  // a damaged variable; the notes state it
    return std::nullopt;
  }
}

/// Mean and scatter of a series.
struct Spread {
  double count = 0.0;
  double sum = 0.0;
  double squares = 0.0;

  void add(double value) {
    count += 1.0;
    sum += value;
    squares += value * value;
  }
  double mean() const { return sum / count; }
  double scatter() const { return std::sqrt(std::max(0.0, squares / count - mean() * mean())); }
};

/// Differences from the original processing in flight, by the state of the flaps.
struct FlapsDifferences {
  std::set<std::string> variables{};
  std::vector<std::string> flights_without{};
  std::array<std::pair<const char*, Spread>, 3> by_flaps{
      {{"retracted", {}}, {"extended", {}}, {"unknown", {}}}};

  /// @param difference in flight, NaN elsewhere
  void add(const Series& difference, const std::optional<std::vector<bool>>& extended) {
    for (std::size_t i = 0; i < difference.size(); ++i) {
      if (!std::isnan(difference[i]))
        by_flaps[!extended ? 2 : (*extended)[i] ? 1 : 0].second.add(difference[i]);
    }
  }
};

/// The series of the outputs, one flight after another.
class Outputs {
 public:
  Outputs(Report& report, const std::string& suffix) : report_(report), suffix_(suffix) {}

  const FlapsDifferences& differences() const { return differences_; }

  void add(const ProcessedFlight& processed) {
    const Flight output(readable_output(processed.output));
    const Series time = record_times(output);
    report_.flight_starts.push_back(report_.time.size());
    report_.flight_names.push_back(processed.output.filename().string());
    report_.time.insert(report_.time.end(), time.begin(), time.end());
    for (std::size_t i = 0; i + 1 < columns_.size(); ++i) {
      const std::string name = processed.model.output_name(columns_[i].name) + suffix_;
      const std::string unit = columns_[i].unit.empty() ? "1" : columns_[i].unit;
      Series values;
      if (output.has(name)) values = read_values(output, name, output.conversion(name, unit)).values;
      append(columns_[i], values);
    }
    add_difference(processed);
  }

  void end() {
    for (ReportColumn& column : columns_) add_if_present(report_, std::move(column));
  }

 private:
  void add_difference(const ProcessedFlight& processed) {
    const Flight input(processed.input);
    const RecordedSeries original = original_static_pressure(input);
    Series difference = original.values;
    const std::size_t first = report_.flight_starts.back();
    for (std::size_t i = 0; i < difference.size(); ++i)
      difference[i] = columns_[static_column].values[first + i] - difference[i];
    append(columns_.back(), difference);
    if (difference.empty()) return differences_.flights_without.push_back(report_.flight_names.back());
    differences_.variables.insert(original.variable);
    if (processed.state != FlightState::processed) return;  // its summary is empty
    for (std::size_t i = 0; i < difference.size(); ++i) {
      const double measured =
          columns_[dynamic_column].values[first + i] + columns_[delta_column].values[first + i];
      if (!(measured >= processed.summary.flying_dynamic_pressure)) difference[i] = std::nan("");
    }
    differences_.add(difference, flaps_of(input, processed.model));
  }

  void append(ReportColumn& column, Series values) const {
    values.resize(report_.time.size() - report_.flight_starts.back(), std::nan(""));
    column.values.insert(column.values.end(), values.begin(), values.end());
  }

  Report& report_;
  const std::string& suffix_;
  std::vector<ReportColumn> columns_{
      {"PCOR", "delta-p", "hPa", {}},
      {"PCOR_uncertainty", "standard uncertainty of delta-p", "hPa", {}},
      {"PSXC", "corrected static pressure", "hPa", {}},
      {"QCXC", "corrected dynamic pressure", "hPa", {}},
      {"MACHX", "Mach number", "", {}},
      {"ATX", "ambient temperature", "degC", {}},
      {"TASX", "true airspeed", "m/s", {}},
      {difference_from_original, "static pressure minus that of the original processing", "hPa", {}}};
  FlapsDifferences differences_{};
};

ReportTable differences_table(const FlapsDifferences& differences) {
  ReportTable table{
      "Difference from the original processing, in flight",
      fmt::format("Corrected static pressure minus {} of the input. Scatter: standard deviation.",
                  fmt::join(differences.variables, ", ")),
      {"flaps", "samples", "mean (hPa)", "scatter (hPa)"}};
  for (const auto& [flaps, spread] : differences.by_flaps) {
    if (spread.count > 0.0)
      table.rows.push_back({flaps, fmt::format("{:.0f}", spread.count),
                            fmt::format("{:+.3f}", std::round(1e3 * spread.mean()) / 1e3 + 0.0),
                            fmt::format("{:.3f}", spread.scatter())});
  }
  return table;
}

void add_pictures(Report& report, const FlapsDifferences& differences) {
  add_if_present(report,
                 TimePanel{"Delta-p in time",
                           "Correction added to the static pressure and subtracted from the dynamic "
                           "pressure; the band is its standard uncertainty, if the model states one. "
                           "Times for which the law was not fitted are shaded.",
                           {"PCOR"},
                           "delta-p",
                           meet(report.columns, {"PCOR", "PCOR_uncertainty"}) ? "PCOR_uncertainty" : ""});
  const std::vector<std::string> states = present(report, {"MACHX", "QCXC", "PSXC"});
  if (!states.empty() && column_named(report.columns, "PCOR") != nullptr)
    report.items.emplace_back(BinnedPanel{
        "Delta-p by the state of flight", "The samples, and their mean in each bin.", {"PCOR"}, states});
  add_if_present(report, TimePanel{"Difference from the original processing",
                                   fmt::format("Corrected static pressure minus {} of the input: 1 hPa is "
                                               "about 8 m of height at the ground.{}",
                                               fmt::join(differences.variables, ", "),
                                               differences.flights_without.empty()
                                                   ? ""
                                                   : " Flights without this variable: " +
                                                         join_list(differences.flights_without) + "."),
                                   {difference_from_original},
                                   "difference of static pressure"});
  if (ReportTable table = differences_table(differences); !table.rows.empty())
    report.items.emplace_back(std::move(table));
  add_if_present(report, TimePanel{"True airspeed", "Computed from the corrected pressures.", {"TASX"}});
  add_if_present(report, TimePanel{"Ambient temperature",
                                   "Computed from the recovery temperature and the corrected Mach number.",
                                   {"ATX"}});
}

ReportTable flights_table(const std::vector<ProcessedFlight>& flights) {
  ReportTable table{"Flights",
                    "Delta-p of samples in flight.",
                    {"flight", "model", "state", "samples", "corrected", "mean delta-p (hPa)",
                     "minimum delta-p (hPa)", "maximum delta-p (hPa)"}};
  for (const ProcessedFlight& flight : flights) {
    std::vector<std::string> row{
        flight.input.filename().string(), flight.model.model.name,
        flight.reason.empty() ? std::string(to_string(flight.state)) : "not corrected: " + flight.reason};
    if (flight.state == FlightState::processed) {
      const ProcessSummary& summary = flight.summary;
      for (const std::size_t count : {summary.samples, summary.corrected})
        row.push_back(std::to_string(count));
      for (const double value : {summary.mean_defect, summary.min_defect, summary.max_defect})
        row.push_back(std::isfinite(value) ? fmt::format("{:.2f}", value) : "");
    }
    row.resize(table.headers.size());
    table.rows.push_back(std::move(row));
  }
  return table;
}

ReportTable flags_table(const std::vector<ProcessedFlight>& flights) {
  ReportTable table{
      "Quality bits",
      "Samples of the flights processed that have each bit of PCORFLAG, flown or on the ground.",
      {"quality bit", "meaning", "samples"}};
  for (std::size_t i = 0; i < quality_info.size(); ++i) {
    std::size_t count = 0;
    for (const ProcessedFlight& flight : flights) count += flight.summary.flagged[i];
    if (count > 0)
      table.rows.push_back(
          {std::string(quality_info[i].name), std::string(quality_info[i].meaning), std::to_string(count)});
  }
  return table;
}

std::string title_of(const std::vector<ProcessedFlight>& flights) {
  if (flights.size() > 1) return fmt::format("Corrections of {} flights", flights.size());
  const ProcessSummary& summary = flights.front().summary;
  return fmt::format("{} of {} samples corrected{}", summary.corrected, summary.samples,
                     summary.in_flight == 0 ? "" : "; in flight " + format_defect(summary));
}

}  // namespace

Report process_report(const std::vector<ProcessedFlight>& flights, const std::string& suffix) {
  Report report;
  report.title = title_of(flights);
  Outputs outputs(report, suffix);
  const auto earlier = std::count_if(flights.begin(), flights.end(), [](const ProcessedFlight& flight) {
    return flight.state == FlightState::up_to_date;
  });
  if (earlier > 0)
    report.summary.push_back(fmt::format(
        "{} of {} flights are up to date. Their warnings, counts, differences and shaded times are "
        "in the report of the run that processed them.",
        earlier, flights.size()));
  for (const ProcessedFlight& flight : flights) {
    if (flight.state != FlightState::unreadable) outputs.add(flight);
    for (const OutsideSpan& span : flight.summary.outside)
      report.intervals.push_back({span.reason, span.begin, span.end});
    for (const Note& note : flight.summary.notes) {
      if (note.severity == Severity::warning) {
        const std::string name = flight.input.filename().string() + ": ";
        report.summary.push_back(sentence((flights.size() > 1 ? name : "") + note.text));
        continue;
      }
      const std::pair<std::string, std::string> fact{label_of(note), note.text};
      if (std::find(report.info.begin(), report.info.end(), fact) == report.info.end())
        report.info.push_back(fact);
    }
  }
  outputs.end();
  add_pictures(report, outputs.differences());
  report.items.emplace_back(flights_table(flights));
  ReportTable flags = flags_table(flights);
  if (!flags.rows.empty()) report.items.emplace_back(std::move(flags));
  return report;
}

}  // namespace pcor
