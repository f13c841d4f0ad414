#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "numerics/missing.hpp"
#include "regimes/search.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t smoothing = 10;  // s
constexpr std::size_t min_side = 10;   // s of known acceleration on each side of an end

// Segments in which the airspeed changes enough, and the height little, over `time` seconds around a cell.
std::vector<Run> branches(double time, const std::vector<double>& airspeed,
                          const std::vector<double>& altitude, const std::vector<bool>& flying,
                          const RegimeCriteria& criteria) {
  const std::size_t half = cells_in(time / 2.0);
  const double change = criteria.acceleration * 2.0 * static_cast<double>(half);
  return runs_where(airspeed.size(), [&](std::size_t i) {
    if (i < half || i + half >= airspeed.size()) return false;
    if (!flying[i - half] || !flying[i] || !flying[i + half]) return false;
    const double climbed = std::abs(altitude[i + half] - altitude[i - half]);
    return std::abs(airspeed[i + half] - airspeed[i - half]) >= change &&
           !(climbed > criteria.speed_run_height);
  });
}

// Merges consecutive branches at one height to one speed run.
std::vector<Run> joined(const std::vector<Run>& runs, const std::vector<double>& altitude,
                        const RegimeCriteria& criteria) {
  std::vector<Run> longer;
  for (const Run& run : runs) {
    const bool near = !longer.empty() && run.first <= longer.back().end + cells_in(criteria.speed_run_pause);
    const Run both{near ? longer.back().first : run.first, run.end};
    if (near && !(extent(altitude, both).range() > 2.0 * criteria.speed_run_height)) {
      longer.back() = both;
    } else {
      longer.push_back(run);
    }
  }
  return longer;
}

bool overlaps_any(Run run, const std::vector<Run>& others) {
  return std::any_of(others.begin(), others.end(),
                     [&](const Run& other) { return run.first < other.end && other.first < run.end; });
}

// Run whose ends are the start and the end of the acceleration.
Run sharpened(Run run, const std::vector<double>& acceleration, const RegimeCriteria& criteria) {
  const std::size_t reach = 2 * cells_in(criteria.branch_time);
  const std::size_t inside = std::min(reach, run.length() / 2);
  const Run at_first{run.first - std::min(run.first, reach), run.first + inside};
  const Run at_end{run.end - inside, std::min(run.end + reach, acceleration.size())};
  return {best_step(acceleration, at_first, min_side, run.first),
          best_step(acceleration, at_end, min_side, run.end)};
}

}  // namespace

std::vector<Found> find_speed_runs(const Cells& cells, const std::vector<bool>& flying,
                                   const RegimeCriteria& criteria) {
  std::vector<Found> found;
  const std::vector<double> airspeed = running_mean(cells.airspeed, smoothing);
  const std::vector<double> altitude = running_mean(cells.altitude, smoothing);
  std::vector<double> acceleration(cells.count(), nan);
  for (std::size_t i = 0; i + 1 < cells.count(); ++i) {
    if (flying[i] && flying[i + 1]) acceleration[i] = airspeed[i + 1] - airspeed[i];
  }
  const std::vector<Run> sustained =
      branches(criteria.acceleration_time, airspeed, altitude, flying, criteria);
  const std::vector<Run> all =
      not_shorter(branches(criteria.branch_time, airspeed, altitude, flying, criteria),
                  cells_in(criteria.branch_time / 2.0));
  for (const Run& run : joined(all, altitude, criteria)) {
    if (!overlaps_any(run, sustained)) continue;
    const Run whole = sharpened(run, acceleration, criteria);
    const Extent speeds = extent(airspeed, whole);
    if (!(speeds.range() >= criteria.speed_range)) continue;
    if (extent(altitude, whole).range() > 2.0 * criteria.speed_run_height) continue;
    found.push_back(
        {Regime::speed_run, whole, 0, fmt::format("{:.0f} to {:.0f} m/s", speeds.minimum, speeds.maximum)});
  }
  return found;
}

}  // namespace pcor::internal
