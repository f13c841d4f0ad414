#pragma once

#include <pcor/base/note.hpp>
#include <pcor/campaign/flight_set.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/report/report.hpp>
#include <pcor/residuals/residuals.hpp>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pcor {

/// Verdict of a check on the correction.
enum class CheckVerdict {
  consistent,    ///< |value| + 2 standard errors is within the tolerance
  inconsistent,  ///< |value| exceeds the tolerance and 3 standard errors
  inconclusive   ///< neither
};

/// Text: "consistent", "inconsistent", "inconclusive".
std::string_view to_string(CheckVerdict verdict);

/// Test statistic with expected value zero, and the verdict on it alone.
struct TestStatistic {
  double value = 0.0;
  double standard_error = 0.0;
  double tolerance = 0.0;  ///< smallest value that matters
  std::string unit{};      ///< unit, e.g. "hPa"
  std::string what{};      ///< description, for example "from slow to fast"
  CheckVerdict verdict = CheckVerdict::inconclusive;
};

template <class Field>
void describe(const TestStatistic& self, Field& field) {
  field("value", self.value, "test statistic, expected to be zero", "see unit");
  field("stderr", self.standard_error, "standard error of the value", "see unit");
  field("matters", self.tolerance, "tolerance: smallest value that matters", "see unit");
  field("unit", self.unit, "unit of the value");
  field("what", self.what, "description of the value");
  field("verdict", self.verdict, "verdict on this value alone");
}

/// Independent test of the correction, on all flights together.
struct CheckResult {
  std::string name{};    ///< e.g. "reverse-heading"
  bool was_run = false;  ///< false: the flights do not permit the check
  std::string reason{};  ///< reason for which it did not run, and its requirements; empty if it ran
  CheckVerdict verdict = CheckVerdict::inconclusive;
  std::vector<TestStatistic> statistics{};  ///< all test statistics
  TestStatistic key{};                      ///< the deciding statistic
  /// Explanation of the verdict: value, standard error and tolerance, without full stop.
  std::string explanation{};
  /// Reason for which the check is inconclusive regardless of its numbers; empty without such a reason.
  std::string inconclusive_reason{};
  std::string finding{};  ///< verdict as a sentence with its numbers
  /// Limitations: errors to which the check is insensitive, one sentence.
  std::string limitations{};
  std::vector<std::pair<std::string, double>> numbers{};  ///< values by name with unit, e.g. "offset_hpa"
  std::vector<ReportTable> tables{};                      ///< e.g. one row for each pair of legs
  Notes notes{};                                          ///< notes for the user, one sentence each

  /// Series of the pictures, over all records of all flights in order; names start with that of the check.
  std::vector<ReportColumn> columns{};
  std::vector<ReportBar> bars{};  ///< values of each manoeuvre, layer or period with their errors

  /// Value of `numbers` by its name; NaN if absent.
  double number(std::string_view of) const;
};

template <class Field>
void describe(const CheckResult& self, Field& field) {
  field("name", self.name, "name of the check");
  field("ran", self.was_run, "whether the flights permit the check");
  field("reason", self.reason, "reason for which the check did not run, and its requirements");
  field("verdict", self.was_run ? &self.verdict : nullptr, "consistent, inconsistent, inconclusive; null");
  field("key", self.was_run ? &self.key : nullptr, "deciding test statistic; null if it did not run");
  field("judged", self.statistics, "all test statistics");
  field("decided", self.explanation, "explanation of the verdict: value, standard error and tolerance");
  field("numbers", self.numbers, "further results", "see the name");
  field("finding", self.finding, "verdict as a sentence");
  field("cannot_see", self.limitations, "errors to which the check is insensitive");
  field.list("tables", self.tables, "tables of the report", [](const ReportTable& table, Field& of_table) {
    of_table("title", table.title, "title of the table");
    of_table("headers", table.headers, "names of the columns");
    of_table("rows", table.rows, "cells of each row");
  });
  field("notes", self.notes, "notes on the check");
}

struct CheckOptions {
  MaskOptions mask;
  /// Model of a second static system of the aircraft, for the checks of redundant systems. Default: the
  /// second pair of pressures, found by its usual names, as measured.
  std::optional<ModelDefinition> second{};
  std::function<void(std::size_t done, std::size_t total)>
      progress{};  ///< callback after every flight of this rank
};

/// Results of all checks.
struct Checks {
  std::string model;       ///< description of the model, or "as recorded"
  bool has_model = false;  ///< false: the pressures are those of the flight file
  std::vector<std::string> flights;
  std::vector<CheckResult> results;  ///< results of all checks, in the order of the memo
  Notes notes;
  Report pictures;  ///< time, flights, intervals and columns of the figures
};

template <class Field>
void describe(const Checks& self, Field& field) {
  field("model", self.model, "name of the model, or \"as recorded\"");
  field("flights", self.flights, "files of the flights");
  field("checks", self.results, "results of the checks");
  field("notes", self.notes, "notes on the flights");
}

/// Tests the corrections of `model` with independent measurements (the memo's Supporting Evidence for
/// Accuracy of p_t, Tests Using Flight Maneuvers and Determining the Air Temperature): the total pressure and
/// the corrected static pressure of redundant systems, the wind on reverse headings, in circles and in speed
/// runs, the residual in pitch and yaw manoeuvres, the temperature of layers, the temperature of the laser,
/// and the spectrum of delta-p. A check that the flights do not permit gives its reason.
///
/// Without a model, pressures and temperature are those corrected in the flight file (PSXC, QCXC, ATX),
/// otherwise the measured ones, without further correction. Flights without valid pressures are excluded,
/// with a note.
///
/// @throws Error if a flight cannot be read or is listed twice, a variable of the model is absent, the
/// flights are of different aircraft, or both models use the same pressures.
Checks check(const FlightSet& flights, const std::optional<ModelDefinition>& model,
             const CheckOptions& options = {});

/// Results of the checks for each flight separately: name, was_run, reason, verdict, key and
/// inconclusive_reason only.
/// @throws Error as `check`
std::vector<std::vector<CheckResult>> check_per_flight(const FlightSet& flights,
                                                       const std::optional<ModelDefinition>& model,
                                                       const CheckOptions& options = {});

/// Common verdict of the checks, one sentence without its full stop.
std::string summary_of(const Checks& checks);

/// Report of the checks: a table of verdicts, and for each check its numbers, tables and figures.
Report check_report(const Checks& checks);

}  // namespace pcor
