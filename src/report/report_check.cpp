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

template <class... Values>
[[noreturn]] void fail(fmt::format_string<Values...> what, const Values&... values) {
  throw Error(Error::Code::usage, "report: " + fmt::format(what, values...));
}

[[noreturn]] void fail_empty(const std::string& title) {
  fail("panel '{}' would be empty: no sample has a value; remove the panel", title);
}

struct CheckItem {
  const Report& report;

  // Whether some sample has a value in every one of the columns that the panel names.
  bool meet(const std::string& panel, std::initializer_list<std::string> names) const {
    for (const std::string& name : names) {
      if (column_named(report.columns, name) == nullptr)
        fail("panel '{}' shows column '{}', which is not in the report; add it", panel, name);
    }
    return internal::meet(report.columns, names);
  }

  void require(const std::string& panel, std::initializer_list<std::string> names) const {
    if (!meet(panel, names)) fail_empty(panel);
  }

  // A panel of columns: some sample has a value in one of them. All names are looked up.
  template <class Panel>
  void operator()(const Panel& panel) const {
    bool found = false;
    for (const std::string& name : panel.columns) found = meet(panel.title, {name}) || found;
    if (!found) fail_empty(panel.title);
  }

  void operator()(const TimePanel& panel) const {
    operator()<TimePanel>(panel);
    if (!panel.uncertainty.empty()) require(panel.title, {panel.columns.front(), panel.uncertainty});
  }

  void operator()(const BinnedPanel& panel) const {
    if (panel.bins == 0) fail("panel '{}' has no bins; give at least one", panel.title);
    if (!(panel.autocorrelation_time >= 1.0))
      fail("panel '{}': samples_per_independent must be a number from 1 on; 1 is for independent samples",
           panel.title);
    if (panel.x_choices.empty()) fail_empty(panel.title);
    for (const std::string& x : panel.x_choices) {
      bool found = false;
      for (const std::string& y : panel.y) found = meet(panel.title, {x, y}) || found;
      if (!found) fail_empty(panel.title);
    }
  }

  void operator()(const PlanePanel& panel) const { require(panel.title, {panel.x, panel.y, panel.colour}); }

  void operator()(const PairPanel& panel) const { require(panel.title, {panel.x, panel.y}); }

  void operator()(const BarPanel& panel) const {
    if (std::none_of(panel.bars.begin(), panel.bars.end(),
                     [](const ReportBar& bar) { return std::isfinite(bar.value); }))
      fail_empty(panel.title);
  }

  void operator()(const CurvePanel& panel) const {
    std::size_t shown = 0;
    for (const ReportCurve& curve : panel.curves) {
      if (curve.x.size() != curve.y.size() || (!curve.error.empty() && curve.error.size() != curve.x.size()))
        fail("curve '{}' of panel '{}' has {} places, {} values and {} errors; give as many of each",
             curve.label, panel.title, curve.x.size(), curve.y.size(), curve.error.size());
      for (std::size_t i = 0; i < curve.x.size(); ++i) {
        if (panel.log_x && !(curve.x[i] > 0.0))
          fail("curve '{}' of panel '{}' has a position at or below zero on a logarithmic axis; remove it",
               curve.label, panel.title);
        if (std::isfinite(curve.y[i])) ++shown;
      }
    }
    if (shown == 0) fail_empty(panel.title);
  }

  void operator()(const TrackPanel& panel) const {
    require(panel.title, {panel.latitude, panel.longitude, panel.colour});
  }

  void operator()(const DotPanel& panel) const {
    bool shown = false;
    for (const ReportDotRow& row : panel.rows) {
      if (row.dots.size() != panel.series.size())
        fail("row '{}' of panel '{}' has {} dots for {} series; give as many", row.label, panel.title,
             row.dots.size(), panel.series.size());
      for (const ReportDot& dot : row.dots) shown = shown || std::isfinite(dot.value);
    }
    if (!shown) fail_empty(panel.title);
  }

  void operator()(const WhatIfPanel& panel) const {
    require(panel.title, {panel.residual});
    if (panel.effects.empty()) fail("panel '{}' has no effect to switch on; remove the panel", panel.title);
    for (const WhatIfCoefficient& coefficient : panel.coefficients)
      if (coefficient.column.size() != report.time.size())
        fail(
            "coefficient '{}' of panel '{}' has {} values for {} samples; give one per sample, NaN where "
            "missing",
            coefficient.name, panel.title, coefficient.column.size(), report.time.size());
    for (const WhatIfEffect& effect : panel.effects)
      if (effect.first < panel.own || effect.first + effect.count > panel.coefficients.size())
        fail(
            "effect '{}' of panel '{}' has coefficients that are not in the panel; correct its first and "
            "count",
            effect.id, panel.title);
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
      fail(
          "panel '{}' has incomplete sums or a size other than {} coefficients and the residual; give the "
          "sums of all parts",
          panel.title, panel.coefficients.size());
    for (const std::string& x : panel.x_choices) require(panel.title, {x, panel.residual});
  }

  void operator()(const ReportTable& table) const {
    if (table.rows.empty()) fail("table '{}' has no rows; remove it", table.title);
    for (const auto& row : table.rows)
      if (row.size() != table.headers.size())
        fail("table '{}' has a row of {} cells under {} headers; give as many", table.title, row.size(),
             table.headers.size());
  }

  void operator()(const ReportText&) const {}
};

void check_flights(const Report& report) {
  const auto& starts = report.flight_starts;
  const std::size_t flights = std::max<std::size_t>(starts.size(), 1);
  if (!report.flight_names.empty() && report.flight_names.size() != flights)
    fail("{} names for {} flights; give as many, or an empty list", report.flight_names.size(), flights);
  for (std::size_t i = 0; i < starts.size(); ++i)
    if (i == 0 ? starts[0] != 0 : starts[i] <= starts[i - 1] || starts[i] >= report.time.size())
      fail("the flights do not begin one after another at samples from 0 on; correct flight_starts");
}

void check_columns(const Report& report) {
  std::set<std::string> names;
  for (const ReportColumn& column : report.columns) {
    if (!names.insert(column.name).second)
      fail("two columns are named '{}'; use distinct names", column.name);
    if (column.values.size() != report.time.size())
      fail("column '{}' has {} values for {} samples; give one per sample, NaN where missing", column.name,
           column.values.size(), report.time.size());
  }
}

void check_time(const Report& report) {
  const auto& time = report.time;
  const auto& starts = report.flight_starts;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!std::isfinite(time[i])) fail("sample {} has no time; remove it", i);
    const bool first = i == 0 || std::binary_search(starts.begin(), starts.end(), i);
    if (!first && time[i] <= time[i - 1])
      fail("time does not increase at sample {}; sort the samples of each flight", i);
  }
}

}  // namespace

void check(const Report& report) {
  check_flights(report);
  check_time(report);
  check_columns(report);
  for (const ReportInterval& interval : report.intervals)
    if (!(interval.begin <= interval.end))
      fail("an interval '{}' ends before it begins; correct it", interval.name);
  for (const ReportItem& item : report.items) std::visit(CheckItem{report}, item);
}

}  // namespace pcor::internal::report
