#include <pcor/process/process_report.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <pcor/base/atomic_file.hpp>
#include <pcor/flight/flight.hpp>
#include "report/columns.hpp"
#include "roles/recorded_series.hpp"
#include "roles/usual_variables.hpp"

namespace pcor {

using namespace internal;

namespace {

using Series = std::vector<double>;

/// A result as the page shows it.
struct Shown {
  const char* standard_name;
  const char* title;
  const char* unit;
};

constexpr std::array<Shown, 7> shown{{{"PCOR", "delta-p", "hPa"},
                                      {"PCOR_uncertainty", "standard uncertainty of delta-p", "hPa"},
                                      {"PSXC", "corrected static pressure", "hPa"},
                                      {"QCXC", "corrected dynamic pressure", "hPa"},
                                      {"MACHX", "Mach number", "1"},
                                      {"ATX", "ambient temperature", "degC"},
                                      {"TASX", "true airspeed", "m/s"}}};

constexpr const char* own_difference = "own_difference";

/// Static pressure corrected in the flight file, hPa; empty if absent.
Series own_static_pressure(const Flight& input) {
  const VariableNaming& family = family_of(input);
  const std::string variable = processed_static_pressure(input, family);
  if (variable.empty()) return {};
  return read_values(input, variable, input.conversion(variable, "hPa", "", family.unit_of(variable))).values;
}

/// The series of the outputs, one flight after another.
class Outputs {
 public:
  Outputs(Report& report, const std::string& suffix) : report_(report), suffix_(suffix) {
    for (const Shown& each : shown)
      columns_.push_back(
          {each.standard_name, each.title, std::string_view(each.unit) == "1" ? "" : each.unit, {}});
    columns_.push_back({own_difference, "static pressure minus that of the original processing", "hPa", {}});
  }

  void add(const ProcessedFlight& processed) {
    const Flight output(readable_output(processed.output));
    const Series time = record_times(output);
    report_.flight_starts.push_back(report_.time.size());
    report_.flight_names.push_back(processed.output.filename().string());
    report_.time.insert(report_.time.end(), time.begin(), time.end());
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const std::string name = processed.model.output_name(shown[i].standard_name) + suffix_;
      Series values;
      if (output.has(name)) values = read_values(output, name, output.conversion(name, shown[i].unit)).values;
      append(columns_[i], values);
    }
    Series difference = own_static_pressure(Flight(processed.input));
    const Series& corrected = columns_[2].values;
    const std::size_t first = report_.flight_starts.back();
    for (std::size_t i = 0; i < difference.size(); ++i) difference[i] = corrected[first + i] - difference[i];
    append(columns_.back(), difference);
  }

  void end() {
    for (ReportColumn& column : columns_) add_if_present(report_, std::move(column));
  }

 private:
  void append(ReportColumn& column, Series values) const {
    values.resize(report_.time.size() - report_.flight_starts.back(), std::nan(""));
    column.values.insert(column.values.end(), values.begin(), values.end());
  }

  Report& report_;
  const std::string& suffix_;
  std::vector<ReportColumn> columns_;
};

void add_pictures(Report& report) {
  add_if_present(report,
                 TimePanel{"Delta-p in time",
                           "Correction added to the static pressure and subtracted from the dynamic "
                           "pressure; the band is its standard uncertainty, if the model states one. "
                           "Drag over a time range to restrict all figures to it.",
                           {"PCOR"},
                           "delta-p",
                           meet(report.columns, {"PCOR", "PCOR_uncertainty"}) ? "PCOR_uncertainty" : ""});
  const std::vector<std::string> states = present(report, {"MACHX", "QCXC", "PSXC"});
  if (!states.empty() && column_named(report.columns, "PCOR") != nullptr)
    report.items.emplace_back(BinnedPanel{
        "Delta-p by the state of flight", "The samples, and their mean in each bin.", {"PCOR"}, states});
  add_if_present(report, TimePanel{"Difference from the original processing",
                                   "Corrected static pressure minus the corrected static pressure of the "
                                   "input: 1 hPa is about 8 m of height at the ground.",
                                   {own_difference},
                                   "difference of static pressure"});
  add_if_present(report, TimePanel{"True airspeed", "Computed from the corrected pressures.", {"TASX"}});
  add_if_present(report, TimePanel{"Ambient temperature",
                                   "Computed from the recovery temperature and the corrected Mach number.",
                                   {"ATX"}});
}

std::string hpa(double value) { return std::isfinite(value) ? fmt::format("{:.2f}", value) : std::string(); }

ReportTable flights_table(const std::vector<ProcessedFlight>& flights) {
  ReportTable table;
  table.title = "Flights";
  table.caption = "Delta-p of samples in flight.";
  table.headers = {"flight",
                   "model",
                   "state",
                   "samples",
                   "corrected",
                   "mean delta-p (hPa)",
                   "minimum delta-p (hPa)",
                   "maximum delta-p (hPa)"};
  for (const ProcessedFlight& flight : flights) {
    std::vector<std::string> row{flight.input.filename().string(), flight.model.model.name,
                                 std::string(to_string(flight.state))};
    if (flight.state == FlightState::processed) {
      const ProcessSummary& summary = flight.summary;
      for (const std::size_t count : {summary.samples, summary.corrected})
        row.push_back(std::to_string(count));
      for (const double value : {summary.mean_defect, summary.min_defect, summary.max_defect})
        row.push_back(hpa(value));
    } else {
      if (!flight.reason.empty()) row.back() += ": " + flight.reason;
      row.resize(table.headers.size());
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

ReportTable flags_table(const std::vector<ProcessedFlight>& flights) {
  ReportTable table;
  table.title = "Quality bits";
  table.caption = "Samples of the flights processed that have each bit of PCORFLAG, flown or on the ground.";
  table.headers = {"quality bit", "meaning", "samples"};
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
                     summary.in_flight == 0
                         ? ""
                         : fmt::format("; delta-p {:.2f} hPa on average in flight", summary.mean_defect));
}

}  // namespace

Report process_report(const std::vector<ProcessedFlight>& flights, const std::string& suffix) {
  Report report;
  report.title = title_of(flights);
  Outputs outputs(report, suffix);
  for (const ProcessedFlight& flight : flights) {
    if (flight.state != FlightState::unreadable) outputs.add(flight);
    for (const Note& note : flight.summary.notes) {
      const std::pair<std::string, std::string> fact{label_of(note), note.text};
      if (std::find(report.info.begin(), report.info.end(), fact) == report.info.end())
        report.info.push_back(fact);
    }
  }
  outputs.end();
  add_pictures(report);
  report.items.emplace_back(flights_table(flights));
  ReportTable flags = flags_table(flights);
  if (!flags.rows.empty()) report.items.emplace_back(std::move(flags));
  return report;
}

}  // namespace pcor
