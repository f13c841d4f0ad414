#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include <pcor/diagnose/what_if.hpp>
#include <pcor/numerics/noise.hpp>
#include <pcor/report/report.hpp>
#include "report/columns.hpp"

/// Columns, panels and tables shared by the reports of diagnose and improve.
namespace pcor::internal::report {

using Flights = std::vector<FlightDiagnosis>;
using Series = std::vector<double>;
using Info = std::vector<std::pair<std::string, std::string>>;

inline constexpr const char* structure_caption =
    "A slope or curvature larger than the error bars indicates an effect that the model lacks.";
inline constexpr const char* effect_caption =
    "Without the effect the residual has a slope or curvature larger than the error bars; with the effect it "
    "should have neither.";

/// Name of one of several columns, "residual1".
std::string numbered(const char* name, std::size_t number);

/// One of several series of a flight; empty if the index is too large.
Series one_of(const std::vector<Series>& all, std::size_t number);

/// Names of the columns that an effect depends on; the pressure comes last because most effects grow with it.
std::vector<std::string> inputs_of(const ModelEffect& effect);

/// Whether the reference of the flights is a laser.
bool reads_laser(const Diagnosis& diagnosis);

/// Text of a number; empty for NaN.
std::string cell(double value, int decimals);

/// Columns and panels of a report about diagnoses of the same flights. Its samples are those with a residual
/// in the first diagnosis.
class DiagnosisPanels {
 public:
  explicit DiagnosisPanels(const Flights& flights);

  Report& report() { return report_; }

  template <class Panel>
  void add(Panel panel) {
    report_.items.emplace_back(std::move(panel));
  }

  /// Adds the column if it has any value, and returns whether it did. @param series of a `FlightDiagnosis`
  template <class Of>
  bool add_column(const std::string& name, const std::string& title, const std::string& unit,
                  const Flights& flights, const Of& series) {
    Series values;
    values.reserve(report_.time.size());
    for (const Used& used : used_) {
      const bool same = used.number < flights.size() && flights[used.number].samples != nullptr &&
                        flights[used.number].samples->time.size() == used.samples->time.size();
      const Series part = same ? series(flights[used.number]) : Series{};
      for (const std::size_t i : used.records)
        values.push_back(i < part.size() ? part[i] : std::numeric_limits<double>::quiet_NaN());
    }
    if (std::none_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); })) return false;
    report_.columns.push_back({name, title, unit == "1" ? "" : unit, std::move(values)});
    return true;
  }

  /// Adds the column as `add_column` does, for a variable on the axis of residual plots.
  template <class Of>
  void add_variable(const std::string& name, const std::string& title, const std::string& unit,
                    const Flights& flights, const Of& series) {
    if (column_named(report_.columns, name) == nullptr && add_column(name, title, unit, flights, series))
      variables_.push_back(name);
  }

  /// Whether some sample has a value in all of these columns.
  bool meet(const std::vector<std::string>& names) const;

  void add_time(std::string title, std::string caption, std::vector<std::string> columns, std::string axis);

  /// Residuals against the variables; the existing variables of `first` are shown first.
  void add_binned(std::string title, std::string caption, std::vector<std::string> y,
                  const std::vector<std::string>& first);

  /// Response of the model's pressure to the reference's: coherence, delay and step response of each residual
  /// column. `by_dynamic_pressure` for a laser reference; otherwise static pressure.
  void add_responses(const std::vector<std::string>& residuals, bool by_dynamic_pressure);

  /// Interactive effects; empty if there is no effect.
  /// @param residual initial column
  /// @param first existing variables that come before the others
  /// @param noise hPa, with its label
  void add_what_if(const WhatIf& what_if, const std::string& residual, const std::vector<std::string>& first,
                   double noise, const std::string& noise_label = "noise");

  void add_plane(std::string title, std::string caption, const std::string& colour);

  /// Adds the table unless it has no rows.
  void add_table(ReportTable table);

  /// Estimates the correlation of the noise, for error bars, from a residual without structure.
  template <class Of>
  void measure_memory(const Flights& flights, const Of& series) {
    double samples = 0.0;
    double independent = 0.0;
    for (const FlightDiagnosis& flight : flights) {
      if (flight.samples == nullptr) continue;
      const Series& values = series(flight);
      if (values.size() != flight.samples->time.size()) continue;
      const double step = flight.samples->step;
      const NoiseFloor noise =
          noise_floor(values, contiguous_segments(values, flight.samples->time, step), step);
      const auto count = static_cast<double>(
          std::count_if(values.begin(), values.end(), [](double x) { return std::isfinite(x); }));
      samples += count;
      independent += count / noise.autocorrelation_time;
    }
    if (independent > 0.0) memory_ = std::max(1.0, samples / independent);
  }

  void add_flight_info();

  std::vector<ReportBarb> wind() const;

 private:
  /// Flight and its samples shown in the report.
  struct Used {
    std::size_t number;
    const FlightSamples* samples;
    std::vector<std::size_t> records;
  };

  void add_variables(const Flights& flights);
  /// Variables that have values in samples of one of the columns, `first` first.
  std::vector<std::string> choices(const std::vector<std::string>& y,
                                   const std::vector<std::string>& first) const;

  Report report_;
  std::vector<Used> used_;
  std::vector<std::string> variables_;
  double memory_ = 1.0;
};

/// @param numbers further text after the model and the reference
void add_info(DiagnosisPanels& panels, const Diagnosis& diagnosis, const ModelDefinition& model,
              const Info& numbers);

/// Upper limits, and effects that could not be seen or tested.
void add_tables(DiagnosisPanels& panels, const Diagnosis& diagnosis);

/// Unexplained structure, and the variable that it varies with.
/// @param left column of the remaining residual
void add_unexplained(DiagnosisPanels& panels, const Diagnosis& diagnosis, const std::string& left);

/// Variable with the most unexplained structure, if any.
void add_traced(DiagnosisPanels& panels, const Diagnosis& diagnosis);

/// Coefficients that a diagnosis fits before it looks for effects: "the model's own coefficients fitted
/// again".
std::string refitted_text(const Diagnosis& diagnosis);

/// @param refitted `refitted_text` of the residuals
void add_residual_in_time(DiagnosisPanels& panels, const std::vector<std::string>& residuals,
                          const std::string& refitted);

/// Flight profile with its regimes, and the residuals in each regime.
/// @param refitted `refitted_text` of the residuals
void add_residual_by_regime(DiagnosisPanels& panels, const std::vector<std::string>& residuals,
                            const std::string& refitted);

/// Periods, locations and distribution of the residuals.
void add_distribution_panels(DiagnosisPanels& panels, const std::vector<std::string>& residuals);

}  // namespace pcor::internal::report
