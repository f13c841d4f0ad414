#include "report/shown_flights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "report/columns.hpp"

namespace pcor::internal {

namespace {

/// Some of the flights, at even distances in the order of time.
template <class Begin>
std::vector<std::size_t> spread(std::vector<std::size_t> flights, std::size_t maximum, const Begin& begin) {
  std::stable_sort(flights.begin(), flights.end(),
                   [&](std::size_t a, std::size_t b) { return begin(a) < begin(b); });
  const std::size_t count = std::min(flights.size(), maximum);
  std::vector<std::size_t> some;
  for (std::size_t k = 0; k < count; ++k) some.push_back(flights[(2 * k + 1) * flights.size() / (2 * count)]);
  return some;
}

/// Keeps the records and intervals of some flights of a report.
void show_only(Report& report, const std::vector<std::size_t>& flights) {
  const std::vector<std::size_t> bounds = flight_bounds(report);
  std::vector<std::size_t> samples;
  std::vector<std::size_t> starts;
  std::vector<std::string> names;
  std::vector<ReportInterval> intervals;
  for (const std::size_t flight : flights) {
    const std::size_t first = bounds[flight];
    const std::size_t end = bounds[flight + 1];
    if (first == end) continue;
    starts.push_back(samples.size());
    names.push_back(report.flight_names[flight]);
    for (std::size_t i = first; i < end; ++i) samples.push_back(i);
    const double begins = report.time[first];
    const double ends = report.time[end - 1];
    std::copy_if(report.intervals.begin(), report.intervals.end(), std::back_inserter(intervals),
                 [&](const ReportInterval& each) { return each.end >= begins && each.begin <= ends; });
  }
  const auto cut = [&samples](std::vector<double>& values) {
    for (std::size_t k = 0; k < samples.size(); ++k) values[k] = values[samples[k]];
    values.resize(samples.size());
  };
  cut(report.time);
  for (ReportColumn& column : report.columns) cut(column.values);
  report.flight_starts = std::move(starts);
  report.flight_names = std::move(names);
  report.intervals = std::move(intervals);
}

}  // namespace

std::vector<std::size_t> flights_to_show(const std::vector<FlightToShow>& flights, std::size_t maximum) {
  std::vector<std::size_t> all(flights.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  if (flights.size() <= maximum) return all;
  all.erase(
      std::remove_if(all.begin(), all.end(), [&](std::size_t f) { return std::isnan(flights[f].failure); }),
      all.end());
  std::stable_sort(all.begin(), all.end(),
                   [&](std::size_t a, std::size_t b) { return flights[a].failure > flights[b].failure; });
  const auto worst = all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), maximum / 2));
  std::vector<std::size_t> chosen(all.begin(), worst);
  for (const std::size_t f : spread({worst, all.end()}, maximum - chosen.size(),
                                    [&](std::size_t each) { return flights[each].begin; }))
    chosen.push_back(f);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

void show_flights_over_time(Report& report, std::size_t maximum) {
  std::vector<std::size_t> all(report.flight_starts.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::vector<std::size_t> shown = spread(all, maximum, [&report](std::size_t flight) {
    const std::size_t first = report.flight_starts[flight];
    return first < report.time.size() ? report.time[first] : std::numeric_limits<double>::infinity();
  });
  if (shown.size() == all.size()) return;
  std::sort(shown.begin(), shown.end());
  report.summary.push_back(
      format_shown_flights(shown.size(), all.size(), "flights spread over the campaign"));
  show_only(report, shown);
}

std::string format_shown_flights(std::size_t shown, std::size_t flights, const std::string& which) {
  if (shown >= flights) return "";
  return fmt::format(
      "The pictures of samples, and selections in them, show {} of the {} flights: {}. All other results "
      "cover all flights.",
      shown, flights, which);
}

}  // namespace pcor::internal
