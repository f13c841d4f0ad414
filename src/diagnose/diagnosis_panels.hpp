#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <pcor/diagnose/diagnose.hpp>
#include <pcor/diagnose/what_if.hpp>
#include <pcor/report/report.hpp>
#include "report/columns.hpp"
#include "residuals/flight_report.hpp"

/// Columns, panels and tables shared by the reports of diagnose and improve.
namespace pcor::internal::report {

using Flights = std::vector<FlightDiagnosis>;
using Series = std::vector<double>;
using Info = std::vector<std::pair<std::string, std::string>>;

/// Name of one of several columns, "residual1".
std::string numbered(const char* name, std::size_t number);

/// Names of the columns that an effect depends on; the pressure comes last because most effects grow with it.
std::vector<std::string> inputs_of(const ModelEffect& effect);

/// Coefficients that a diagnosis fits before it looks for effects: "the model's own coefficients fitted
/// again".
std::string refitted_text(const Diagnosis& diagnosis);

/// Text of a number; empty for NaN.
std::string cell(double value, int decimals);

/// Columns and panels of a report about diagnoses of the same flights. Its samples are those with a residual
/// in the first diagnosis.
class DiagnosisPanels : public FlightReport {
 public:
  explicit DiagnosisPanels(const Flights& flights);

  template <class Panel>
  void add(Panel panel) {
    report().items.emplace_back(std::move(panel));
  }

  /// Adds the columns of one finding, its evidence and its contribution, with the names of
  /// `numbered(..., number)`. @param id of the effect
  void add_finding_columns(const Flights& flights, std::size_t finding, const std::string& id,
                           std::size_t number);

  /// Adds the variable with the most unexplained structure, if any, to the axes of residual plots.
  void add_predictor(const Diagnosis& diagnosis);

  /// Adds the picture of residuals against this variable, once.
  void add_against_predictor(const Diagnosis& diagnosis, const std::string& residual);

  /// Residuals against the variables; the existing variables of `first` are shown first. Error bars are by
  /// the noise of the last residual.
  /// @param y one residual, or the residuals before and after effects are added
  void add_binned(std::string title, const std::vector<std::string>& y,
                  const std::vector<std::string>& first);

  /// Interactive effects; empty if there is no effect.
  /// @param residual initial column
  /// @param first existing variables that come before the others
  /// @param noise hPa, with its label
  void add_what_if(const WhatIf& what_if, const std::string& residual, const std::vector<std::string>& first,
                   double noise, const std::string& noise_label = "noise");

  void add_plane(std::string title, std::string caption, const std::string& colour);

  /// Adds the table unless it has no rows.
  void add_table(ReportTable table);

  /// @param numbers further text after the model and the reference
  void add_info(const Diagnosis& diagnosis, const ModelDefinition& model, const Info& numbers);

  /// Residuals in time, flight profile with its regimes, and residuals in each regime.
  void add_residuals(const Diagnosis& diagnosis, const std::vector<std::string>& residuals);

  /// Last panels of a report: periods, locations and distribution of the residuals, the unexplained part of
  /// the last one, and the tables of effects that were not found.
  void add_last_panels(const Diagnosis& diagnosis, const std::vector<std::string>& residuals);

 private:
  /// Adds the column as `add_column` does, for a variable on the axis of residual plots.
  template <class Of>
  void add_variable(const std::string& name, const std::string& title, const std::string& unit,
                    const Flights& flights, const Of& series) {
    if (column_named(report().columns, name) == nullptr && add_column(name, title, unit, flights, series))
      variables_.push_back(name);
  }
  void add_variables(const Flights& flights);
  /// Caption of residuals against a variable; before and after an effect is added, with both rms values.
  std::string binned_caption(const std::vector<std::string>& y) const;
  /// Variables that have values in samples of one of the columns, `first` first.
  std::vector<std::string> choices(const std::vector<std::string>& y,
                                   const std::vector<std::string>& first) const;
  /// Unexplained structure, and the variable that it varies with.
  /// @param residual column of the remaining residual
  void add_unexplained(const Diagnosis& diagnosis, const std::string& residual);

  std::vector<std::string> variables_;
  bool has_predictor_picture_ = false;
};

}  // namespace pcor::internal::report
