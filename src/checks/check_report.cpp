#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <pcor/base/utc.hpp>
#include <pcor/checks/check.hpp>
#include "base/phrasing.hpp"
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

/// Whether a picture has values: a report refuses an empty one.
class Shows {
 public:
  explicit Shows(const std::vector<ReportColumn>& columns) : columns_(columns) {}

  // One column with values is enough.
  template <class Panel>
  bool operator()(const Panel& panel) const {
    return std::any_of(panel.columns.begin(), panel.columns.end(),
                       [this](const std::string& name) { return meet({name}); });
  }
  bool operator()(const TrackPanel& panel) const {
    return meet({panel.latitude, panel.longitude, panel.colour});
  }
  bool operator()(const DotPanel& panel) const { return !panel.rows.empty(); }
  bool operator()(const BinnedPanel& panel) const {
    return std::all_of(panel.x_choices.begin(), panel.x_choices.end(), [&](const std::string& x) {
      return std::any_of(panel.y.begin(), panel.y.end(), [&](const std::string& y) { return meet({x, y}); });
    });
  }
  bool operator()(const PlanePanel& panel) const { return meet({panel.x, panel.y, panel.colour}); }
  bool operator()(const PairPanel& panel) const { return meet({panel.x, panel.y}); }
  bool operator()(const CurvePanel& panel) const { return !panel.curves.empty(); }
  bool operator()(const WhatIfPanel& panel) const { return meet({panel.residual}); }
  bool operator()(const BarPanel& panel) const {
    return std::any_of(panel.bars.begin(), panel.bars.end(),
                       [](const ReportBar& bar) { return std::isfinite(bar.value); });
  }
  bool operator()(const ReportTable& table) const { return !table.rows.empty(); }
  bool operator()(const ReportText&) const { return true; }

 private:
  bool meet(const std::vector<std::string>& names) const { return internal::meet(columns_, names); }

  const std::vector<ReportColumn>& columns_;
};

ReportTable verdicts(const Checks& checks) {
  ReportTable table;
  table.title = "Verdicts";
  table.caption =
      "Inconsistent: larger than the tolerance and than three standard errors. Consistent: within the "
      "tolerance by two standard errors. Otherwise the check is inconclusive.";
  table.headers = {"check", "verdict", "number", "tolerance", "result"};
  for (const CheckResult& result : checks.results) {
    if (!result.ran) {
      table.rows.push_back({heading(result.name), "not run", "", "", sentence(result.reason)});
      continue;
    }
    const TestStatistic& key = result.key;
    table.rows.push_back(
        {heading(result.name), std::string(to_string(result.verdict)),
         fmt::format("{:+.3f} ± {:.3f} {}, {}", key.value, key.standard_error, key.unit, key.what),
         fmt::format("{:g} {}", key.matters, key.unit), sentence(result.finding)});
  }
  return table;
}

/// Deciding number of each check, in units of its tolerance, with its verdict.
DotPanel forest(const Checks& checks) {
  DotPanel panel;
  panel.title = "Checks at a glance";
  panel.caption =
      "Deciding number of each check divided by its tolerance, with its standard error. A square in the band "
      "is consistent, a cross inconsistent, an open square inconclusive.";
  panel.series = {""};
  panel.axis = "number / tolerance";
  panel.band = "negligible";
  for (const CheckResult& result : checks.results) {
    const TestStatistic& key = result.key;
    if (!result.ran || !(key.matters > 0.0) || !std::isfinite(key.value)) continue;
    const bool is_told = std::isfinite(key.standard_error);
    const double error = is_told ? key.standard_error : 0.0;
    const ReportTone tone = result.verdict == CheckVerdict::consistent     ? ReportTone::good
                            : result.verdict == CheckVerdict::inconsistent ? ReportTone::bad
                                                                           : ReportTone::open;
    panel.rows.push_back({heading(result.name),
                          {{key.value / key.matters, error / key.matters}},
                          is_told ? fmt::format("{:+.3f} ± {:.3f} {}", key.value, error, key.unit)
                                  : fmt::format("{:+.3f} {}, error unknown", key.value, key.unit),
                          tone});
  }
  return panel;
}

ReportTable numbers_of(const CheckResult& result) {
  ReportTable table;
  table.title = heading(result.name) + ": numbers";
  table.caption = "Names as in the JSON result, with the unit at the end of each name.";
  constexpr std::size_t across = 3;  // cells per row
  for (std::size_t i = 0; i < across; ++i) {
    table.headers.emplace_back("number");
    table.headers.emplace_back("value");
  }
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

std::vector<std::string> summary_of(const Checks& checks) {
  const auto count = [&](CheckVerdict verdict) {
    return std::count_if(checks.results.begin(), checks.results.end(), [verdict](const CheckResult& result) {
      return result.ran && result.verdict == verdict;
    });
  };
  const auto ran = std::count_if(checks.results.begin(), checks.results.end(),
                                 [](const CheckResult& result) { return result.ran; });
  std::vector<std::string> summary{
      fmt::format("{} checks, {} with sufficient data: {} consistent, {} inconsistent, {} inconclusive.",
                  checks.results.size(), ran, count(CheckVerdict::consistent),
                  count(CheckVerdict::inconsistent), count(CheckVerdict::inconclusive))};
  for (const CheckResult& result : checks.results) {
    if (result.ran && result.verdict == CheckVerdict::inconsistent)
      summary.push_back(heading(result.name) + ": " + sentence(result.finding));
  }
  return summary;
}

}  // namespace

Report check_report(const Checks& checks) {
  Report report = checks.pictures;
  std::vector<std::string> inconsistent;
  std::size_t ran = 0;
  for (const CheckResult& result : checks.results) {
    if (result.ran) ++ran;
    if (result.ran && result.verdict == CheckVerdict::inconsistent) inconsistent.push_back(result.name);
  }
  report.title = inconsistent.empty() ? "No check is inconsistent"
                                      : fmt::format("{} of {} checks inconsistent: {}", inconsistent.size(),
                                                    ran, fmt::join(inconsistent, ", "));
  report.subtitle = "Independent checks" + (checks.model.empty() ? "" : " of " + checks.model);
  report.summary = summary_of(checks);
  for (const CheckResult& result : checks.results)
    report.columns.insert(report.columns.end(), result.columns.begin(), result.columns.end());
  show_flights_over_time(report);
  for (std::size_t i = 0; i < report.flight_names.size(); ++i) {
    const std::size_t first = report.flight_starts[i];
    const std::size_t end =
        i + 1 < report.flight_starts.size() ? report.flight_starts[i + 1] : report.time.size();
    report.info.emplace_back(
        "Flight", fmt::format("{}, {} to {} UTC", report.flight_names[i], utc_text(report.time[first]),
                              utc_text(report.time[end - 1], "%H:%M:%S")));
  }
  if (report.flight_names.size() < checks.flights.size())
    report.info.emplace_back("All flights", fmt::format("{}", fmt::join(checks.flights, ", ")));
  report.info.emplace_back("Program", "pcor " PCOR_VERSION);
  for (const Note& note : checks.notes) report.info.emplace_back(label_of(note), note.text);
  if (DotPanel picture = forest(checks); !picture.rows.empty()) report.items.emplace_back(std::move(picture));
  report.items.emplace_back(verdicts(checks));
  const Shows shows(report.columns);
  for (const CheckResult& result : checks.results) {
    if (!result.ran) continue;
    ReportText text;
    text.title = fmt::format("{}: {}", heading(result.name), to_string(result.verdict));
    text.paragraphs = {fmt::format("Decided by this number: {}.", result.decided), sentence(result.finding),
                       "Limitations: " + result.cannot_see};
    for (const Note& note : result.notes) text.paragraphs.push_back(sentence(format_note(note)));
    report.items.emplace_back(std::move(text));
    for (const ReportItem& picture : result.pictures) {
      if (std::visit(shows, picture)) report.items.push_back(picture);
    }
    for (const ReportTable& table : result.tables) {
      if (!table.rows.empty()) report.items.emplace_back(table);
    }
    if (ReportTable numbers = numbers_of(result); !numbers.rows.empty())
      report.items.emplace_back(std::move(numbers));
  }
  return report;
}

}  // namespace pcor
