#include <pcor/regimes/regimes.hpp>

#include <algorithm>
#include <tuple>

#include "regimes/regime_search.hpp"

namespace pcor {

using namespace internal;

namespace {

void find_clouds(RegimeSearch& search) {
  const std::vector<IndexRange> wet = runs_where(search.cells.count(), [&](std::size_t i) {
    return search.flying[i] && search.cells.liquid_water[i] >= search.criteria.cloud_liquid_water;
  });
  for (const IndexRange& run : merge_gaps(wet, cells_in(search.criteria.bridged)))
    search.add(Regime::cloud, run);
}

}  // namespace

void RegimeSearch::add(Regime regime, IndexRange run, const std::string& note, int pair) {
  found.push_back({regime, cells.begin[run.first], cells.begin[run.end], pair, note});
  for (std::size_t i = run.first; i < run.end; ++i) unassigned[i] = false;
}

Regime regime_named(std::string_view name) {
  const auto found = std::find_if(regime_info.begin(), regime_info.end(),
                                  [&](const RegimeInfo& info) { return info.name == name; });
  return static_cast<Regime>(found - regime_info.begin());
}

std::vector<Interval> find_regimes(const FlightMotion& motion, const RegimeCriteria& criteria) {
  const OneHertzCells cells = cells_of(motion);
  const std::vector<Regime> phases = phases_of(cells, criteria);
  std::vector<bool> flying;
  for (const Regime phase : phases) flying.push_back(phase != Regime::ground && phase != Regime::take_off);
  RegimeSearch search{cells, criteria, flying, flying};
  find_pitch_manoeuvres(search);
  find_yaw_manoeuvres(search);
  find_speed_runs(search);
  find_reverse_headings(search);  // only in cells outside the regimes found before
  find_circles(search);
  find_turns(search);
  find_clouds(search);
  for (std::size_t first = 0, end = 0; first < phases.size(); first = end) {
    while (end < phases.size() && phases[end] == phases[first]) ++end;
    if (phases[first] != Regime::count) search.add(phases[first], {first, end});
  }
  std::sort(search.found.begin(), search.found.end(), [](const Interval& a, const Interval& b) {
    return std::tie(a.begin, a.regime, a.end) < std::tie(b.begin, b.regime, b.end);
  });
  return std::move(search.found);
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
