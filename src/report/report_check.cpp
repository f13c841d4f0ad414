#include <fmt/format.h>
#include <pcor/base/error.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "report/columns.hpp"
#include "report/report_data.hpp"

namespace pcor::internal::report {

namespace {

[[noreturn]] void fail(const std::string& what) { throw Error(Error::Code::usage, "report: " + what); }

[[noreturn]] void fail_empty(const std::string& title) {
  fail("panel '" + title + "' would be empty: no sample has a value; remove the panel");
}

class Columns {
 public:
  explicit Columns(const Report& report) : columns_(report.columns), samples_(report.time.size()) {
    std::set<std::string> names;
    for (const ReportColumn& column : report.columns) {
      if (!names.insert(column.name).second)
        fail("two columns are named '" + column.name + "'; use distinct names");
      if (column.values.size() != report.time.size())
        fail("column '" + column.name + "' has " + std::to_string(column.values.size()) + " values for " +
             std::to_string(report.time.size()) + " samples; give one per sample, NaN where missing");
    }
  }

  std::size_t samples() const { return samples_; }

  // Whether some sample has a value in every one of the columns that the panel names.
  bool meet(const std::string& panel, std::initializer_list<std::string> names) const {
    for (const std::string& name : names) {
      if (column_named(columns_, name) == nullptr)
        fail(fmt::format("panel '{}' shows column '{}', which is not in the report; add it", panel, name));
    }
    return internal::meet(columns_, names);
  }

  // Whether some sample has a value in one of the columns. All names are looked up.
  bool any(const std::string& panel, const std::vector<std::string>& names) const {
    bool found = false;
    for (const std::string& name : names) found = meet(panel, {name}) || found;
    return found;
  }

 private:
  const std::vector<ReportColumn>& columns_;
  std::size_t samples_;
};

struct CheckItem {
  const Columns& columns;

  template <class Panel>
  void any_of(const Panel& panel) const {
    if (!columns.any(panel.title, panel.columns)) fail_empty(panel.title);
  }

  void operator()(const TimePanel& panel) const {
    any_of(panel);
    if (!panel.uncertainty.empty() && !columns.meet(panel.title, {panel.columns.front(), panel.uncertainty}))
      fail_empty(panel.title);
  }

  void operator()(const BinnedPanel& panel) const {
    if (panel.bins == 0) fail("panel '" + panel.title + "' has no bins; give at least one");
    if (!(panel.autocorrelation_time >= 1.0))
      fail("panel '" + panel.title +
           "': samples_per_independent must be a number from 1 on; 1 is for independent samples");
    if (panel.x_choices.empty()) fail_empty(panel.title);
    for (const std::string& x : panel.x_choices) {
      bool found = false;
      for (const std::string& y : panel.y) found = columns.meet(panel.title, {x, y}) || found;
      if (!found) fail_empty(panel.title);
    }
  }

  void operator()(const PlanePanel& panel) const {
    if (!columns.meet(panel.title, {panel.x, panel.y, panel.colour})) fail_empty(panel.title);
  }

  void operator()(const PairPanel& panel) const {
    if (!columns.meet(panel.title, {panel.x, panel.y})) fail_empty(panel.title);
  }

  void operator()(const RegimeTable& table) const {
    if (!columns.any(table.title, table.columns)) fail_empty(table.title);
  }

  void operator()(const BarPanel& panel) const {
    if (std::none_of(panel.bars.begin(), panel.bars.end(),
                     [](const ReportBar& bar) { return std::isfinite(bar.value); }))
      fail_empty(panel.title);
  }

  void operator()(const CurvePanel& panel) const {
    std::size_t shown = 0;
    for (const ReportCurve& curve : panel.curves) {
      if (curve.x.size() != curve.y.size() || (!curve.error.empty() && curve.error.size() != curve.x.size()))
        fail("curve '" + curve.label + "' of panel '" + panel.title + "' has " +
             std::to_string(curve.x.size()) + " places, " + std::to_string(curve.y.size()) + " values and " +
             std::to_string(curve.error.size()) + " errors; give as many of each");
      for (std::size_t i = 0; i < curve.x.size(); ++i) {
        if (panel.log_x && !(curve.x[i] > 0.0))
          fail("curve '" + curve.label + "' of panel '" + panel.title +
               "' has a position at or below zero on a logarithmic axis; remove it");
        if (std::isfinite(curve.y[i])) ++shown;
      }
    }
    if (shown == 0) fail_empty(panel.title);
  }

  void operator()(const TrackPanel& panel) const {
    if (!columns.meet(panel.title, {panel.latitude, panel.longitude, panel.colour})) fail_empty(panel.title);
  }

  void operator()(const StripPanel& panel) const { any_of(panel); }
  void operator()(const RegimePanel& panel) const { any_of(panel); }
  void operator()(const QuantilePanel& panel) const { any_of(panel); }

  void operator()(const DotPanel& panel) const {
    bool shown = false;
    for (const ReportDotRow& row : panel.rows) {
      if (row.dots.size() != panel.series.size())
        fail("row '" + row.label + "' of panel '" + panel.title + "' has " + std::to_string(row.dots.size()) +
             " dots for " + std::to_string(panel.series.size()) + " series; give as many");
      for (const ReportDot& dot : row.dots) shown = shown || std::isfinite(dot.value);
    }
    if (!shown) fail_empty(panel.title);
  }

  void operator()(const WhatIfPanel& panel) const {
    if (!columns.meet(panel.title, {panel.residual})) fail_empty(panel.title);
    if (panel.effects.empty())
      fail("panel '" + panel.title + "' has no effect to switch on; remove the panel");
    for (const WhatIfCoefficient& coefficient : panel.coefficients)
      if (coefficient.column.size() != columns.samples())
        fail("coefficient '" + coefficient.name + "' of panel '" + panel.title + "' has " +
             std::to_string(coefficient.column.size()) + " values for " + std::to_string(columns.samples()) +
             " samples; give one per sample, NaN where missing");
    for (const WhatIfEffect& effect : panel.effects)
      if (effect.first < panel.own || effect.first + effect.count > panel.coefficients.size())
        fail("effect '" + effect.id + "' of panel '" + panel.title +
             "' has coefficients that are not in the panel; correct its first and count");
    const std::size_t width = panel.coefficients.size() + 1;
    std::vector<WhatIfSums> all = panel.alike;
    for (const WhatIfWeights& each : panel.weights)
      all.insert(all.end(), each.parts.begin(), each.parts.end());
    all.push_back(panel.outliers);
    if (!panel.held_out.products.empty()) all.push_back(panel.held_out);
    if (panel.weights.empty() || !panel.weights.front().effects.empty() ||
        std::any_of(
            panel.weights.begin(), panel.weights.end(),
            [&panel](const WhatIfWeights& each) { return each.parts.size() != panel.alike.size(); }) ||
        std::any_of(all.begin(), all.end(), [width](const WhatIfSums& sums) {
          return sums.products.size() != width * (width + 1) / 2;
        }))
      fail("panel '" + panel.title + "' has incomplete sums or a size other than " +
           std::to_string(panel.coefficients.size()) +
           " coefficients and the residual; give the sums of all parts");
    for (const std::string& x : panel.x_choices)
      if (!columns.meet(panel.title, {x, panel.residual})) fail_empty(panel.title);
  }

  void operator()(const ReportTable& table) const {
    if (table.rows.empty()) fail("table '" + table.title + "' has no rows; remove it");
    for (const auto& row : table.rows)
      if (row.size() != table.headers.size())
        fail("table '" + table.title + "' has a row of " + std::to_string(row.size()) + " cells under " +
             std::to_string(table.headers.size()) + " headers; give as many");
  }

  void operator()(const ReportText&) const {}
};

void check_flights(const Report& report) {
  const auto& starts = report.flight_starts;
  const std::size_t flights = std::max<std::size_t>(starts.size(), 1);
  if (!report.flight_names.empty() && report.flight_names.size() != flights)
    fail(std::to_string(report.flight_names.size()) + " names for " + std::to_string(flights) +
         " flights; give as many, or an empty list");
  for (std::size_t i = 0; i < starts.size(); ++i)
    if (i == 0 ? starts[0] != 0 : starts[i] <= starts[i - 1] || starts[i] >= report.time.size())
      fail("the flights do not begin one after another at samples from 0 on; correct flight_starts");
}

void check_time(const Report& report) {
  const auto& time = report.time;
  const auto& starts = report.flight_starts;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!std::isfinite(time[i])) fail("sample " + std::to_string(i) + " has no time; remove it");
    const bool first = i == 0 || std::binary_search(starts.begin(), starts.end(), i);
    if (!first && time[i] <= time[i - 1])
      fail("time does not increase at sample " + std::to_string(i) + "; sort the samples of each flight");
  }
}

}  // namespace

void check(const Report& report) {
  check_flights(report);
  check_time(report);
  const Columns columns(report);
  for (const ReportInterval& interval : report.intervals)
    if (!(interval.begin <= interval.end))
      fail("an interval '" + interval.name + "' ends before it begins; correct it");
  for (const ReportItem& item : report.items) std::visit(CheckItem{columns}, item);
}

}  // namespace pcor::internal::report
