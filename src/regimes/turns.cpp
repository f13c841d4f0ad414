#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "regimes/regime_search.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t roll_smoothing = 3;       // s: turbulence moves the wings
constexpr std::size_t straight_smoothing = 10;  // s

struct Turn {
  IndexRange run;
  const char* side;
  double change;  // turn of the heading from the first known value to the last, deg, positive to that side
};

double heading_change(const OneHertzCells& cells, IndexRange run) {
  std::size_t first = run.first, last = run.end - 1;
  while (first < last && std::isnan(cells.heading[first])) ++first;
  while (last > first && std::isnan(cells.heading[last])) --last;
  return cells.heading[last] - cells.heading[first];
}

// Turns with a roll beyond `minimum` deg to one side.
std::vector<Turn> turns_beyond(double minimum, const RegimeSearch& search) {
  const std::vector<double> roll = running_mean(search.cells.roll, roll_smoothing);
  std::vector<Turn> turns;
  for (const double sign : {-1.0, 1.0}) {
    const std::vector<IndexRange> banked =
        runs_where(roll.size(), [&](std::size_t i) { return search.flying[i] && sign * roll[i] > minimum; });
    const std::vector<IndexRange> bridged_runs = merge_gaps(banked, cells_in(search.criteria.bridged));
    for (const IndexRange& run : drop_short(bridged_runs, cells_in(search.criteria.turn_time)))
      turns.push_back({run, sign > 0.0 ? "right" : "left", sign * heading_change(search.cells, run)});
  }
  return turns;
}

double standard_deviation(const std::vector<double>& values, IndexRange run) {
  const double middle = mean(values, run);
  std::vector<double> squares(values.data() + run.first, values.data() + run.end);
  for (double& each : squares) each = (each - middle) * (each - middle);
  return std::sqrt(mean_of(squares));
}

}  // namespace

void find_turns(RegimeSearch& search) {
  for (const auto& [run, side, change] : turns_beyond(search.criteria.turn_roll, search)) {
    std::string note = side;
    if (!std::isnan(change)) note += fmt::format(", {:.0f} deg", std::abs(change));
    search.add(Regime::turn, run, note);
  }
}

void find_circles(RegimeSearch& search) {
  const std::vector<double>& roll = search.cells.roll;
  for (const auto& [run, side, change] : turns_beyond(search.criteria.circle_roll, search)) {
    if (!(change >= search.criteria.circle_heading)) continue;
    if (standard_deviation(roll, run) > search.criteria.circle_steadiness) continue;
    search.add(Regime::circle, run,
               fmt::format("{}, {:.0f} deg, roll {:.0f} deg", side, change, std::abs(mean(roll, run))));
  }
}

void find_reverse_headings(RegimeSearch& search) {
  const OneHertzCells& cells = search.cells;
  const RegimeCriteria& criteria = search.criteria;
  const std::vector<double> roll = running_mean(cells.roll, straight_smoothing);
  const std::vector<double> altitude = running_mean(cells.altitude, straight_smoothing);
  const std::size_t shortest = cells_in(criteria.leg_shortest), longest = cells_in(criteria.leg_longest);
  const std::vector<IndexRange> steady = runs_where(cells.count(), [&](std::size_t i) {
    return search.unassigned[i] && std::abs(roll[i]) < criteria.leg_roll && !std::isnan(cells.heading[i]) &&
           !std::isnan(altitude[i]);
  });
  const std::vector<IndexRange> straight =
      drop_short(merge_gaps(steady, cells_in(criteria.bridged)), shortest);
  int pairs = 0;
  for (std::size_t i = 1; i < straight.size(); ++i) {
    const IndexRange first = straight[i - 1], second = straight[i];
    if (second.first - first.end > cells_in(criteria.turn_longest)) continue;
    // The legs are estimated from the shortest ones, next to the reversal.
    IndexRange out{first.end - shortest, first.end};
    IndexRange back{second.first, second.first + shortest};
    const double heading_out = mean(cells.heading, out), heading_back = mean(cells.heading, back);
    const double change = std::abs(std::remainder(heading_back - heading_out, 360.0));
    if (!(180.0 - change <= criteria.leg_heading)) continue;
    const double middle = (mean(cells.altitude, out) + mean(cells.altitude, back)) / 2.0;
    const auto keeps_height = [&](double height) {
      return std::abs(height - middle) <= criteria.leg_height_range / 2.0;
    };
    const auto all_keep = [&](IndexRange run) {
      return std::all_of(altitude.data() + run.first, altitude.data() + run.end, keeps_height);
    };
    if (!all_keep(out) || !all_keep(back)) continue;
    // Extends the legs away from the reversal while the aircraft keeps heading and height.
    const auto keeps = [&](std::size_t k, double heading) {
      return keeps_height(altitude[k]) && std::abs(cells.heading[k] - heading) <= criteria.leg_heading;
    };
    while (out.first > first.first && out.length() < longest && keeps(out.first - 1, heading_out))
      --out.first;
    while (back.end < second.end && back.length() < longest && keeps(back.end, heading_back)) ++back.end;
    ++pairs;
    for (const IndexRange& leg : {out, back})
      search.add(Regime::reverse_heading, leg, fmt::format("headings {:.0f} deg apart", change), pairs);
  }
}

}  // namespace pcor::internal
