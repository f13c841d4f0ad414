#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "regimes/search.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t roll_smoothing = 3;       // s: turbulence moves the wings
constexpr std::size_t straight_smoothing = 10;  // s

struct Turn {
  Run run;
  bool right = false;
};

// Runs of a roll beyond `minimum` deg to one side.
std::vector<Turn> turns_beyond(double minimum, const Cells& cells, const std::vector<bool>& flying,
                               const RegimeCriteria& criteria) {
  const std::vector<double> roll = running_mean(cells.roll, roll_smoothing);
  std::vector<Turn> turns;
  for (const bool right : {false, true}) {
    const std::vector<Run> banked = runs_where(
        cells.count(), [&](std::size_t i) { return flying[i] && (right ? roll[i] : -roll[i]) > minimum; });
    const std::vector<Run> bridged_runs = bridged(banked, cells_in(criteria.bridged));
    for (const Run& run : not_shorter(bridged_runs, cells_in(criteria.turn_time)))
      turns.push_back({run, right});
  }
  return turns;
}

// Heading change from the first known value of a run to the last, deg, positive to the right.
double heading_change(const Cells& cells, Run run) {
  std::size_t first = run.first, last = run.end - 1;
  while (first < last && std::isnan(cells.heading[first])) ++first;
  while (last > first && std::isnan(cells.heading[last])) --last;
  return cells.heading[last] - cells.heading[first];
}

double standard_deviation(const std::vector<double>& values, Run run) {
  const double middle = mean(values, run);
  double squares = 0.0, known = 0.0;
  for (std::size_t i = run.first; i < run.end; ++i) {
    if (std::isnan(values[i])) continue;
    squares += (values[i] - middle) * (values[i] - middle);
    known += 1.0;
  }
  return std::sqrt(squares / known);
}

// A straight part of the flight next to a reversal.
struct Leg {
  Run run;
  double heading = 0.0;  // deg, not wrapped
  double altitude = 0.0;
};

// Leg estimated from the `shortest` cells of a straight run next to the reversal.
Leg leg_beside(const Cells& cells, Run run, bool before, std::size_t shortest) {
  const Run beside = before ? Run{run.end - shortest, run.end} : Run{run.first, run.first + shortest};
  return {beside, mean(cells.heading, beside), mean(cells.altitude, beside)};
}

// Extends a leg away from the reversal while the aircraft keeps heading and height.
template <class Keeps>
void lengthen(Leg& leg, Run straight, bool before, std::size_t longest, Keeps keeps) {
  if (before) {
    while (leg.run.first > straight.first && leg.run.length() < longest && keeps(leg.run.first - 1)) {
      --leg.run.first;
    }
  } else {
    while (leg.run.end < straight.end && leg.run.length() < longest && keeps(leg.run.end)) ++leg.run.end;
  }
}

}  // namespace

std::vector<Found> find_turns(const Cells& cells, const std::vector<bool>& flying,
                              const RegimeCriteria& criteria) {
  std::vector<Found> found;
  for (const Turn& turn : turns_beyond(criteria.turn_roll, cells, flying, criteria)) {
    const double change = std::abs(heading_change(cells, turn.run));
    std::string note = turn.right ? "right" : "left";
    if (!std::isnan(change)) note += fmt::format(", {:.0f} deg", change);
    found.push_back({Regime::turn, turn.run, 0, note});
  }
  return found;
}

std::vector<Found> find_circles(const Cells& cells, const std::vector<bool>& flying,
                                const RegimeCriteria& criteria) {
  std::vector<Found> found;
  for (const Turn& turn : turns_beyond(criteria.circle_roll, cells, flying, criteria)) {
    const double change = heading_change(cells, turn.run) * (turn.right ? 1.0 : -1.0);
    if (!(change >= criteria.circle_heading)) continue;
    if (standard_deviation(cells.roll, turn.run) > criteria.circle_steadiness) continue;
    found.push_back({Regime::circle, turn.run, 0,
                     fmt::format("{}, {:.0f} deg, roll {:.0f} deg", turn.right ? "right" : "left", change,
                                 std::abs(mean(cells.roll, turn.run)))});
  }
  return found;
}

std::vector<Found> find_reverse_headings(const Cells& cells, const std::vector<bool>& usable,
                                         const RegimeCriteria& criteria) {
  std::vector<Found> found;
  const std::vector<double> roll = running_mean(cells.roll, straight_smoothing);
  const std::vector<double> altitude = running_mean(cells.altitude, straight_smoothing);
  const std::size_t shortest = cells_in(criteria.leg_shortest), longest = cells_in(criteria.leg_longest);
  const std::vector<Run> steady = runs_where(cells.count(), [&](std::size_t i) {
    return usable[i] && std::abs(roll[i]) < criteria.leg_roll && !std::isnan(cells.heading[i]) &&
           !std::isnan(altitude[i]);
  });
  const std::vector<Run> straight = not_shorter(bridged(steady, cells_in(criteria.bridged)), shortest);
  for (std::size_t i = 1; i < straight.size(); ++i) {
    const Run first = straight[i - 1], second = straight[i];
    if (second.first - first.end > cells_in(criteria.turn_longest)) continue;
    Leg out = leg_beside(cells, first, true, shortest);
    Leg back = leg_beside(cells, second, false, shortest);
    const double change = std::abs(std::remainder(back.heading - out.heading, 360.0));
    if (!(180.0 - change <= criteria.leg_heading)) continue;
    const double middle = (out.altitude + back.altitude) / 2.0;
    const auto keeps_height = [&](std::size_t k) {
      return std::abs(altitude[k] - middle) <= criteria.leg_height_range / 2.0;
    };
    const auto all_keep = [&](Run run) {
      return runs_where(run.length(), [&](std::size_t k) { return !keeps_height(run.first + k); }).empty();
    };
    if (!all_keep(out.run) || !all_keep(back.run)) continue;
    const auto keeps = [&](double heading) {
      return [&, heading](std::size_t k) {
        return keeps_height(k) && std::abs(cells.heading[k] - heading) <= criteria.leg_heading;
      };
    };
    lengthen(out, first, true, longest, keeps(out.heading));
    lengthen(back, second, false, longest, keeps(back.heading));
    const int pair = static_cast<int>(found.size()) / 2 + 1;
    const std::string note = fmt::format("headings {:.0f} deg apart", change);
    found.push_back({Regime::reverse_heading, out.run, pair, note});
    found.push_back({Regime::reverse_heading, back.run, pair, note});
  }
  return found;
}

}  // namespace pcor::internal
