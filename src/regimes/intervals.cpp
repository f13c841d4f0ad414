#include <pcor/regimes/regimes.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <pcor/base/utc.hpp>

namespace pcor {
namespace {

constexpr double day = 86400.0;  // s

// Moment with that time of day in the flight or nearest to it.
double nearest_moment(double time_of_day, double start_time, double end_time) {
  const auto distance = [&](double time) { return std::max({start_time - time, time - end_time, 0.0}); };
  double moment = midnight_before(start_time) - day + time_of_day;
  for (double next = moment + day; next - day <= end_time; next += day) {
    if (distance(next) < distance(moment)) moment = next;
  }
  return moment;
}

// Places times of the day on the day of the flight.
template <class Span>
void shift_day(Span& span, double start_time, double end_time) {
  if (span.begin < day) span.begin = nearest_moment(span.begin, start_time, end_time);
  if (span.end < day) {
    span.end += midnight_before(span.begin);
    if (span.end <= span.begin) span.end += day;
  }
}

// Removes the intervals that `concerns` from [begin, end), together with the other leg of a pair; parts of
// manoeuvres are not kept.
template <class Concerns>
void remove(std::vector<Interval>& intervals, double begin, double end, Concerns concerns) {
  std::vector<int> pairs;
  std::vector<Interval> kept;
  for (const Interval& interval : intervals) {
    if (!concerns(interval) || interval.end <= begin || end <= interval.begin) {
      kept.push_back(interval);
      continue;
    }
    if (interval.pair != 0) pairs.push_back(interval.pair);
    if (is_manoeuvre(interval.regime)) continue;
    for (const auto& [from, to] : {std::pair(interval.begin, begin), std::pair(end, interval.end)}) {
      if (!(from < to)) continue;
      kept.push_back(interval);
      kept.back().begin = from;
      kept.back().end = to;
    }
  }
  const auto lost_its_partner = [&](const Interval& interval) {
    return std::find(pairs.begin(), pairs.end(), interval.pair) != pairs.end();
  };
  kept.erase(std::remove_if(kept.begin(), kept.end(), lost_its_partner), kept.end());
  intervals = std::move(kept);
}

}  // namespace

bool UserIntervals::is_for(const std::filesystem::path& flight_file) const {
  return flight.empty() || flight_file.filename() == flight;
}

UserIntervals placed(const UserIntervals& user, double start_time, double end_time) {
  UserIntervals result = user;
  for (Interval& interval : result.add) shift_day(interval, start_time, end_time);
  for (Veto& veto : result.veto) shift_day(veto, start_time, end_time);
  for (Exclusion& exclusion : result.exclude) shift_day(exclusion, start_time, end_time);
  return result;
}

std::vector<OutsideInterval> intervals_outside(const UserIntervals& intervals, double start_time,
                                               double end_time) {
  const UserIntervals moments = placed(intervals, start_time, end_time);
  std::vector<OutsideInterval> outside;
  const auto find = [&](const char* kind, const auto& stated, const auto& list) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (list[i].end > start_time && list[i].begin <= end_time) continue;
      const bool is_one_day = midnight_before(list[i].begin) == midnight_before(list[i].end);
      outside.push_back({fmt::format("[[{}]] {} to {}", kind, utc_text(list[i].begin),
                                     utc_text(list[i].end, is_one_day ? "%H:%M:%S" : "%Y-%m-%d %H:%M:%S")),
                         stated[i].begin < day});
    }
  };
  find("add", intervals.add, moments.add);
  find("veto", intervals.veto, moments.veto);
  find("exclude", intervals.exclude, moments.exclude);
  return outside;
}

std::vector<Interval> apply(const UserIntervals& user, std::vector<Interval> found, double start_time,
                            double end_time) {
  const UserIntervals moments = placed(user, start_time, end_time);
  for (const Veto& veto : moments.veto) {
    remove(found, veto.begin, veto.end,
           [&](const Interval& interval) { return !veto.regime || interval.regime == *veto.regime; });
  }
  int pairs = 0;
  double end_of_flight = std::nextafter(end_time, end_time + 1.0);
  for (const Interval& interval : found) {
    pairs = std::max(pairs, interval.pair);
    end_of_flight = std::max(end_of_flight, interval.end);
  }
  std::vector<Interval> added;
  for (Interval interval : moments.add) {
    interval.begin = std::max(interval.begin, start_time);
    interval.end = std::min(interval.end, end_of_flight);
    if (!(interval.begin < interval.end)) continue;
    const auto replaced = [&](const Interval& other) {
      return other.regime == interval.regime || (is_phase(other.regime) && is_phase(interval.regime));
    };
    remove(found, interval.begin, interval.end, replaced);
    if (is_phase(interval.regime)) remove(added, interval.begin, interval.end, replaced);
    if (interval.pair != 0) interval.pair += pairs;
    added.push_back(interval);
  }
  found.insert(found.end(), added.begin(), added.end());
  std::sort(found.begin(), found.end(), [](const Interval& a, const Interval& b) {
    return std::tie(a.begin, a.regime, a.end) < std::tie(b.begin, b.regime, b.end);
  });
  return found;
}

}  // namespace pcor
