#pragma once

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

/// What a check says of the correction.
enum class CheckVerdict {
  consistent,    ///< what is measured agrees within what the noise allows
  inconsistent,  ///< it does not
  inconclusive   ///< the noise allows more than the largest error that would matter
};

/// "consistent", "inconsistent", "cannot tell".
std::string_view to_string(CheckVerdict verdict);

/// A number of a check that would be zero if all were well, with what its size alone says.
struct TestStatistic {
  double value = 0.0;
  double standard_error = 0.0;
  double matters = 0.0;  ///< the smallest value that matters
  std::string unit{};    ///< for example "hPa"
  std::string what{};    ///< in words, for example "from slow to fast"
  CheckVerdict verdict = CheckVerdict::inconclusive;
};

/// One independent test of the correction, on all flights together.
struct CheckResult {
  std::string name{};    ///< for example "reverse-heading"
  bool ran = false;      ///< else the flights do not allow it
  std::string reason{};  ///< why it did not run, and what it would need; empty where it ran
  CheckVerdict verdict = CheckVerdict::inconclusive;
  std::vector<TestStatistic> judged{};  ///< all numbers that were judged
  TestStatistic key{};                  ///< the one of them that decided
  std::string decided{};  ///< how it did: the number, its error and the limit, a sentence without full stop
  std::string finding{};  ///< the verdict in a sentence with its numbers
  std::string cannot_see{};                               ///< which errors the check is blind to, a sentence
  std::vector<std::pair<std::string, double>> numbers{};  ///< by name with the unit, like "offset_hpa"
  std::vector<ReportTable> tables{};                      ///< for example one row for each pair of legs
  std::vector<std::string> notes{};                       ///< what a user should know, a sentence each

  /// What the pictures show, over all records of all flights, one flight after another; names begin with that
  /// of the check.
  std::vector<ReportColumn> columns{};
  std::vector<ReportItem> pictures{};
};

struct CheckOptions {
  MaskOptions mask;
  /// The model of a second static system of the aircraft, for the checks of redundant systems. Without it the
  /// second pair of pressures is looked for by its usual names, and is as measured.
  std::optional<ModelDefinition> second{};
  std::function<void(std::size_t done, std::size_t total)>
      progress{};  ///< told after every flight of this member
};

/// All checks over some flights.
struct Checks {
  std::string model;  ///< in words: the model, or "as recorded"
  std::vector<std::string> flights;
  std::vector<CheckResult> results;  ///< of all checks, in the order of the memo
  std::vector<std::string> notes;
  Report pictures;  ///< time, flights, intervals and columns for the report's pictures
};

/// Holds what `model` makes of the flights against what does not depend on it (the memo's Supporting Evidence
/// for Accuracy of p_t, Tests Using Flight Maneuvers and Determining the Air Temperature):
/// the total pressure and the corrected static pressure of redundant systems, the wind on reverse headings,
/// in circles and in speed runs, the residual in pitch and yaw manoeuvres, the temperature of layers, the
/// temperature of the laser, and the spectrum of delta-p. A check that the flights do not allow says why.
///
/// Without a model the pressures and the temperature are those that the flight's own processing corrected
/// (PSXC, QCXC, ATX), else those measured, and nothing is added to them.
/// A flight whose pressures have no value anywhere is left out, and `notes` says so.
///
/// @throws Error if a flight cannot be read or is given twice, a variable of the model is absent, the flights
/// are of different aircraft, or both models are of the same pressures.
Checks check(const FlightSet& flights, const std::optional<ModelDefinition>& model,
             const CheckOptions& options = {});

/// What a check says in short; the members are those of `CheckResult`.
struct CheckSummary {
  std::string name{};
  bool ran = false;
  std::string reason{};
  CheckVerdict verdict = CheckVerdict::inconclusive;
  TestStatistic key{};
};

std::vector<CheckSummary> in_short(const Checks& checks);

/// What the checks say of each flight alone.
/// @throws Error as `check`
std::vector<std::vector<CheckSummary>> check_per_flight(const FlightSet& flights,
                                                        const std::optional<ModelDefinition>& model,
                                                        const CheckOptions& options = {});

/// The report of the checks: a table of verdicts, and for each check its numbers, tables and pictures.
Report check_report(const Checks& checks);

}  // namespace pcor
