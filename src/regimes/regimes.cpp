#include <pcor/regimes/regimes.hpp>

#include <algorithm>
#include <tuple>

#include "regimes/search.hpp"

namespace pcor {

using namespace internal;

namespace {

std::vector<Found> runs_of(const std::vector<Regime>& phases) {
  std::vector<Found> found;
  for (std::size_t i = 0; i < phases.size(); ++i) {
    if (phases[i] == Regime::count) continue;
    if (!found.empty() && found.back().regime == phases[i] && found.back().run.end == i) {
      found.back().run.end = i + 1;
    } else {
      found.push_back({phases[i], {i, i + 1}});
    }
  }
  return found;
}

void append(std::vector<Found>& all, const std::vector<Found>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

Regime regime_named(std::string_view name) {
  const auto found = std::find_if(regime_info.begin(), regime_info.end(),
                                  [&](const RegimeInfo& info) { return info.name == name; });
  return static_cast<Regime>(found - regime_info.begin());
}

std::vector<Interval> find_regimes(const FlightMotion& motion, const RegimeCriteria& criteria) {
  const Cells cells = cells_of(motion);
  const std::vector<Regime> phases = phases_of(cells, criteria);
  const std::vector<bool> flying = in_flight(phases);
  std::vector<Found> found = find_pitch_manoeuvres(cells, flying, criteria);
  append(found, find_yaw_manoeuvres(cells, flying, criteria));
  append(found, find_speed_runs(cells, flying, criteria));
  std::vector<bool> steady = flying;
  for (const Found& manoeuvre : found) {
    for (std::size_t i = manoeuvre.run.first; i < manoeuvre.run.end; ++i) steady[i] = false;
  }
  append(found, find_reverse_headings(cells, steady, criteria));
  append(found, find_circles(cells, flying, criteria));
  append(found, find_turns(cells, flying, criteria));
  append(found, find_clouds(cells, flying, criteria));
  append(found, runs_of(phases));

  std::vector<Interval> intervals;
  for (const Found& each : found) {
    intervals.push_back(
        {each.regime, cells.begin[each.run.first], cells.begin[each.run.end], each.pair, each.note, false});
  }
  std::sort(intervals.begin(), intervals.end(), [](const Interval& a, const Interval& b) {
    return std::tie(a.begin, a.regime, a.end) < std::tie(b.begin, b.regime, b.end);
  });
  return intervals;
}

std::vector<RegimeSet> regimes_of_samples(const std::vector<double>& time,
                                          const std::vector<Interval>& intervals) {
  std::vector<RegimeSet> regimes(time.size());
  for (const Interval& interval : intervals) {
    const auto first = std::lower_bound(time.begin(), time.end(), interval.begin);
    for (auto sample = first; sample != time.end() && *sample < interval.end; ++sample) {
      regimes[static_cast<std::size_t>(sample - time.begin())].set(static_cast<std::size_t>(interval.regime));
    }
  }
  return regimes;
}

}  // namespace pcor
