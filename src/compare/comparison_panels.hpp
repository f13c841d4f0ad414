#pragma once

#include <pcor/compare/compare.hpp>
#include <pcor/report/report.hpp>

#include <string>
#include <vector>

#include "residuals/flight_report.hpp"

namespace pcor::internal {

/// Columns that all pictures of a comparison share, and the panels common to all its reports.
class ComparisonPanels {
 public:
  explicit ComparisonPanels(const Comparison& comparison);

  Report& report() { return samples_.report(); }

  /// Label of a model in titles, pictures and tables: its name, or its number.
  std::string label_of_model(const ModelComparison& model) const;

  void add_panels();
  /// Comparison of the two systems: figures 1 and 2 of the memo.
  void add_pairs();
  void add_tables();
  void summarise();

 private:
  template <class Series>
  void add(const std::string& name, const std::string& title, const Series& series);

  /// A title with the label of the model, if there are several.
  std::string title_of(const std::string& what, const ModelComparison& model) const;
  /// The names of numbered models.
  void add_model_table();

  const Comparison& comparison_;
  const std::vector<std::string> labels_{model_labels(comparison_)};
  FlightReport samples_;
  std::vector<std::string> residuals_;
  std::vector<std::string> variables_;
  std::vector<std::string> defects_;  // names of delta-p of the reference and of every model
};

}  // namespace pcor::internal
