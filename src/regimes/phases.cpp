#include <algorithm>
#include <cmath>

#include "regimes/regime_search.hpp"

namespace pcor::internal {
namespace {

// Shorter times above or below the flying speed are noise, s.
constexpr std::size_t min_flight = 30;

// Maximum distance of the start of a phase from the change of the smoothed vertical speed, s.
constexpr std::size_t boundary_reach = 90;
constexpr std::size_t min_phase_side = 15;

struct PhaseRun {
  Regime phase;
  IndexRange run;
};

// Airborne cells: faster than the flying speed. Unknown speeds take the last known value, or the next one
// before the first.
std::vector<bool> airborne(const OneHertzCells& cells, const RegimeCriteria& criteria) {
  std::vector<bool> flying(cells.count());
  const auto first_known = std::find_if(cells.airspeed.begin(), cells.airspeed.end(),
                                        [](double speed) { return !std::isnan(speed); });
  bool fast = first_known != cells.airspeed.end() && *first_known > criteria.flying_speed;
  for (std::size_t i = 0; i < flying.size(); ++i) {
    if (!std::isnan(cells.airspeed[i])) fast = cells.airspeed[i] > criteria.flying_speed;
    flying[i] = fast;
  }
  for (const bool state : {true, false}) {
    for (const IndexRange& run :
         runs_where(flying.size(), [&](std::size_t i) { return flying[i] == state; })) {
      const bool whole_record = run.length() == flying.size();
      if (run.length() >= min_flight || whole_record) continue;
      for (std::size_t i = run.first; i < run.end; ++i) flying[i] = !state;
    }
  }
  return flying;
}

// Start of the roll that reached the flying speed at `fast`.
std::size_t begin_of_roll(const OneHertzCells& cells, std::size_t fast, const RegimeCriteria& criteria) {
  const std::size_t earliest = fast - std::min(fast, cells_in(criteria.take_off_time));
  std::size_t begin = fast;
  while (begin > earliest && cells.airspeed[begin - 1] > criteria.roll_speed) --begin;
  return begin;
}

std::size_t end_of_take_off(const OneHertzCells& cells, IndexRange flight, std::size_t roll,
                            const RegimeCriteria& criteria) {
  const double field = mean(cells.altitude, {roll, flight.first});
  const std::size_t latest = std::min(flight.end, flight.first + cells_in(criteria.take_off_time));
  std::size_t end = flight.first;
  while (end < latest && !(cells.altitude[end] - field >= criteria.take_off_height)) ++end;
  return end;
}

Regime phase_at(double climb, const RegimeCriteria& criteria) {
  if (climb > criteria.climb_rate) return Regime::climb;
  if (climb < -criteria.climb_rate) return Regime::descent;
  return Regime::level;
}

// If the climb is unknown the previous phase continues; the initial phase is level.
std::vector<PhaseRun> runs_of_phase(const std::vector<double>& climb, IndexRange flight,
                                    const RegimeCriteria& criteria) {
  std::vector<PhaseRun> runs;
  Regime phase = Regime::level;
  for (std::size_t i = flight.first; i < flight.end; ++i) {
    if (!std::isnan(climb[i])) phase = phase_at(climb[i], criteria);
    if (runs.empty() || runs.back().phase != phase) runs.push_back({phase, {i, i}});
    ++runs.back().run.end;
  }
  return runs;
}

// Merges the shortest run with the neighbour of more similar vertical speed, until all runs are long enough.
void join_short(std::vector<PhaseRun>& runs, const std::vector<double>& climb, std::size_t shortest) {
  const auto length = [](const PhaseRun& a, const PhaseRun& b) { return a.run.length() < b.run.length(); };
  while (runs.size() > 1) {
    const auto shorter = std::min_element(runs.begin(), runs.end(), length);
    if (shorter->run.length() >= shortest) return;
    const auto unlike = [&](const PhaseRun& other) {
      const double difference = std::abs(mean(climb, other.run) - mean(climb, shorter->run));
      return std::isnan(difference) ? infinity : difference;
    };
    const bool joins_next = shorter == runs.begin() ||
                            (shorter + 1 != runs.end() && unlike(*(shorter + 1)) < unlike(*(shorter - 1)));
    if (joins_next) {
      (shorter + 1)->run.first = shorter->run.first;
    } else {
      (shorter - 1)->run.end = shorter->run.end;
    }
    const auto next = runs.erase(shorter);
    if (next != runs.begin() && next != runs.end() && next->phase == (next - 1)->phase) {
      (next - 1)->run.end = next->run.end;
      runs.erase(next);
    }
  }
}

// Moves each boundary to the best fit of a step to the vertical speed; boundaries of the smoothed speed are
// too early or too late.
void sharpen(std::vector<PhaseRun>& runs, const std::vector<double>& vertical_speed) {
  for (std::size_t i = 1; i < runs.size(); ++i) {
    IndexRange& before = runs[i - 1].run;
    IndexRange& after = runs[i].run;
    const std::size_t boundary = after.first;
    const IndexRange around{boundary - std::min(boundary_reach, before.length() / 2),
                            boundary + std::min(boundary_reach, after.length() / 2)};
    before.end = after.first = best_step(vertical_speed, around, min_phase_side, boundary);
  }
}

}  // namespace

std::vector<Regime> phases_of(const OneHertzCells& cells, const RegimeCriteria& criteria) {
  std::vector<Regime> phases(cells.count(), Regime::count);
  if (!has_value(cells.airspeed)) return phases;
  const std::vector<bool> flying = airborne(cells, criteria);
  std::fill(phases.begin(), phases.end(), Regime::ground);
  const auto put = [&](IndexRange run, Regime phase) {
    for (std::size_t i = run.first; i < run.end; ++i) phases[i] = phase;
  };
  for (const IndexRange& flight : runs_where(flying.size(), [&](std::size_t i) { return flying[i]; })) {
    IndexRange rest = flight;
    if (flight.first > 0) {
      const std::size_t roll = begin_of_roll(cells, flight.first, criteria);
      rest.first = end_of_take_off(cells, flight, roll, criteria);
      put({roll, rest.first}, Regime::take_off);
    }
    std::vector<double> vertical_speed(cells.count(), nan);
    for (std::size_t i = flight.first; i < flight.end; ++i) vertical_speed[i] = cells.vertical_speed[i];
    put(rest, Regime::count);
    if (!has_value(cells.vertical_speed)) continue;
    const std::vector<double> climb = smoothed_twice(vertical_speed, cells_in(criteria.climb_smoothing));
    std::vector<PhaseRun> runs = runs_of_phase(climb, rest, criteria);
    join_short(runs, climb, cells_in(criteria.phase_time));
    sharpen(runs, vertical_speed);
    for (const PhaseRun& run : runs) put(run.run, run.phase);
  }
  return phases;
}

}  // namespace pcor::internal
