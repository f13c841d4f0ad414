#include "diagnose/events.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

namespace pcor::internal {
namespace {

/// Joins the events of one flight that overlap by more than half, each against another reference.
std::vector<Evidence> without_repeats(std::vector<Evidence> events) {
  std::stable_sort(events.begin(), events.end(), [](const Evidence& a, const Evidence& b) {
    return std::tie(a.flight, a.begin) < std::tie(b.flight, b.begin);
  });
  std::vector<Evidence> joined;
  for (Evidence& event : events) {
    const bool is_of_same = !joined.empty() && joined.back().flight == event.flight;
    const double end = is_of_same ? std::min(joined.back().end, event.end) : event.begin;
    if (!(2.0 * (end - event.begin) > event.end - event.begin)) {
      joined.push_back(std::move(event));
      continue;
    }
    joined.back().end = std::max(joined.back().end, event.end);
    joined.back().share += event.share;
  }
  return joined;
}

/// Regimes between two times, e.g. "level, yaw manoeuvre".
std::string regimes_between(const FlightSamples& samples, double begin, double end) {
  std::set<Regime> regimes;
  for (const Interval& interval : samples.intervals) {
    if (interval.begin < end && interval.end > begin) regimes.insert(interval.regime);
  }
  std::vector<std::string_view> names;
  for (const Regime regime : regimes) names.push_back(info_of(regime).name);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::vector<Evidence> events_of(const Analysis& analysis, const Eigen::VectorXd& evidence) {
  constexpr double minute = 60.0;  // s
  const WhitenedSystem& scores = analysis.scores();
  // A minute is part of an event if its evidence is above average.
  const double share = evidence.cwiseMax(0.0).sum() / static_cast<double>(evidence.size());
  std::vector<Evidence> events;
  for (const std::vector<Evidence>& more :
       analysis.whole_partition().all_gather_flights<std::vector<Evidence>>([&](std::size_t f) {
         std::vector<Evidence> of_flight;
         const FlightSamples& samples = *analysis.flight(f).samples;
         const std::vector<double>& time = analysis.bins(f).time();
         Eigen::Index before = -1;
         for (std::size_t i = 0; i < time.size(); ++i) {
           const Eigen::Index block = scores.block[f][i];
           if (block == before) continue;
           before = block;
           if (evidence[block] > share) {
             if (of_flight.empty() || time[i] > of_flight.back().end + minute)
               of_flight.push_back({samples.name, time[i], time[i], "", 0.0});
             of_flight.back().end = time[i] + minute;
             of_flight.back().share += evidence[block];
           }
         }
         for (Evidence& event : of_flight) event.regimes = regimes_between(samples, event.begin, event.end);
         return of_flight;
       }))
    events.insert(events.end(), more.begin(), more.end());
  return without_repeats(std::move(events));
}

double count_of(const std::vector<Evidence>& events) {
  double sum = 0.0;
  double squares = 0.0;
  for (const Evidence& event : events) {
    sum += event.share;
    squares += event.share * event.share;
  }
  return squares > 0.0 ? sum * sum / squares : 0.0;
}

}  // namespace pcor::internal
