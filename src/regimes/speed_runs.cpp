#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "regimes/regime_search.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t smoothing = 10;  // s
constexpr std::size_t min_side = 10;   // s of known acceleration on each side of an end

// Run whose ends are the start and the end of the acceleration.
IndexRange sharpened(IndexRange run, const std::vector<double>& acceleration,
                     const RegimeCriteria& criteria) {
  const std::size_t margin = 2 * cells_in(criteria.branch_time);
  const std::size_t inside = std::min(margin, run.length() / 2);
  const IndexRange at_first{run.first - std::min(run.first, margin), run.first + inside};
  const IndexRange at_end{run.end - inside, std::min(run.end + margin, acceleration.size())};
  return {best_step(acceleration, at_first, min_side, run.first),
          best_step(acceleration, at_end, min_side, run.end)};
}

}  // namespace

void find_speed_runs(RegimeSearch& search) {
  const OneHertzCells& cells = search.cells;
  const RegimeCriteria& criteria = search.criteria;
  const std::vector<bool>& flying = search.flying;
  const std::vector<double> airspeed = running_mean(cells.airspeed, smoothing);
  const std::vector<double> altitude = running_mean(cells.altitude, smoothing);
  std::vector<double> acceleration(cells.count(), nan);
  for (std::size_t i = 0; i + 1 < cells.count(); ++i) {
    if (flying[i] && flying[i + 1]) acceleration[i] = airspeed[i + 1] - airspeed[i];
  }
  const auto at_one_height = [&](IndexRange run) {
    return !(extent(altitude, run).range() > 2.0 * criteria.speed_run_height);
  };
  // Segments in which the airspeed changes enough, and the height little, over `time` seconds around a cell.
  const auto branches = [&](double time) {
    const std::size_t half = cells_in(time / 2.0);
    const double change = criteria.acceleration * 2.0 * static_cast<double>(half);
    return runs_where(cells.count(), [&](std::size_t i) {
      if (i < half || i + half >= cells.count()) return false;
      if (!flying[i - half] || !flying[i] || !flying[i + half]) return false;
      const double climbed = std::abs(altitude[i + half] - altitude[i - half]);
      return std::abs(airspeed[i + half] - airspeed[i - half]) >= change &&
             !(climbed > criteria.speed_run_height);
    });
  };
  const std::vector<IndexRange> sustained = branches(criteria.acceleration_time);
  const std::vector<IndexRange> all =
      drop_short(branches(criteria.branch_time), cells_in(criteria.branch_time / 2.0));
  for (const IndexRange& run : merge_gaps(all, cells_in(criteria.speed_run_pause), at_one_height)) {
    const bool is_sustained = std::any_of(sustained.begin(), sustained.end(), [&](const IndexRange& other) {
      return run.first < other.end && other.first < run.end;
    });
    if (!is_sustained) continue;
    const IndexRange whole = sharpened(run, acceleration, criteria);
    const Extent speeds = extent(airspeed, whole);
    if (!(speeds.range() >= criteria.speed_range) || !at_one_height(whole)) continue;
    search.add(Regime::speed_run, whole, fmt::format("{:.0f} to {:.0f} m/s", speeds.minimum, speeds.maximum));
  }
}

}  // namespace pcor::internal
