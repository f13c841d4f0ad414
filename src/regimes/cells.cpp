#include "regimes/regime_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <pcor/base/error.hpp>
#include <pcor/physics/constants.hpp>

namespace pcor::internal {
namespace {

constexpr double max_kept_gap = 300.0;        // s
constexpr std::size_t max_interpolation = 5;  // cells
constexpr double max_vertical_speed = 40.0;   // m/s; a faster change is a jump of the height, not a climb
constexpr double rounding = 1e-6;             // s, rounding error of a time since 1970 in double precision

// Cell of each sample.
struct Division {
  std::vector<std::size_t> cell;
  std::vector<double> begin;
};

Division divide(const std::vector<double>& time) {
  Division division;
  double first_begin = 0.0;  // begin of the cells since the last cut gap
  std::size_t first_cell = 0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!std::isfinite(time[i]) || (i > 0 && !(time[i] > time[i - 1]))) {
      throw Error(
          Error::Code::time,
          fmt::format("flight motion: the time of sample {} is not after the previous time; give strictly "
                      "increasing times",
                      i));
    }
    if (i == 0) first_begin = time[0];
    if (i > 0 && time[i] - time[i - 1] > max_kept_gap) {
      first_cell = division.begin.size() + static_cast<std::size_t>(max_kept_gap);
      while (division.begin.size() < first_cell) division.begin.push_back(division.begin.back() + 1.0);
      first_begin = time[i];
    }
    const auto cell = first_cell + static_cast<std::size_t>(std::floor(time[i] - first_begin + rounding));
    while (division.begin.size() <= cell) {
      division.begin.push_back(first_begin + static_cast<double>(division.begin.size() - first_cell));
    }
    division.cell.push_back(cell);
  }
  if (!division.begin.empty()) division.begin.push_back(division.begin.back() + 1.0);
  return division;
}

void interpolate_short_gaps(std::vector<double>& values) {
  std::size_t last = values.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    if (last < i && i - last - 1 <= max_interpolation) {
      const double slope = (values[i] - values[last]) / static_cast<double>(i - last);
      for (std::size_t j = last + 1; j < i; ++j)
        values[j] = values[last] + slope * static_cast<double>(j - last);
    }
    last = i;
  }
}

std::vector<double> means(const std::vector<double>& samples, const Division& division, const char* name) {
  const std::size_t count = division.begin.empty() ? 0 : division.begin.size() - 1;
  std::vector<double> sum(count, 0.0), known(count, 0.0);
  if (!samples.empty() && samples.size() != division.cell.size()) {
    throw Error(
        Error::Code::usage,
        fmt::format(
            "flight motion: {} has {} values for {} times; give one value per time, or an empty series", name,
            samples.size(), division.cell.size()));
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!std::isfinite(samples[i])) continue;
    sum[division.cell[i]] += samples[i];
    known[division.cell[i]] += 1.0;
  }
  for (std::size_t i = 0; i < count; ++i) sum[i] = known[i] > 0.0 ? sum[i] / known[i] : nan;
  interpolate_short_gaps(sum);
  return sum;
}

// The change per second from each known value to the next one, over any gap between them.
std::vector<double> rate_of_change(const std::vector<double>& values, const std::vector<double>& begin) {
  std::vector<double> rate(values.size(), nan);
  std::size_t last = values.size();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    if (last < i) {
      const double slope = (values[i] - values[last]) / (begin[i] - begin[last]);
      std::fill(rate.begin() + static_cast<std::ptrdiff_t>(last),
                rate.begin() + static_cast<std::ptrdiff_t>(i), slope);
    }
    last = i;
  }
  return rate;
}

std::vector<double> coordinated_roll(const OneHertzCells& cells) {
  constexpr std::size_t smoothing = 3;
  constexpr double radians = constants::radians_per_degree;
  std::vector<double> roll = running_mean(rate_of_change(cells.heading, cells.begin), smoothing);
  for (std::size_t i = 0; i < roll.size(); ++i) {
    roll[i] = std::atan(roll[i] * radians * cells.airspeed[i] / constants::standard_gravity) / radians;
  }
  return roll;
}

const std::vector<double>& first_known(const std::vector<double>& preferred,
                                       const std::vector<double>& substitute) {
  return has_value(preferred) ? preferred : substitute;
}

}  // namespace

OneHertzCells cells_of(const FlightMotion& motion) {
  const Division division = divide(motion.time);
  OneHertzCells cells;
  cells.begin = division.begin;
  cells.airspeed = means(first_known(motion.airspeed, motion.ground_speed), division, "the airspeed");
  cells.altitude = means(motion.altitude, division, "the altitude");
  cells.vertical_speed = means(motion.vertical_speed, division, "the vertical speed");
  cells.roll = means(motion.roll, division, "the roll");
  cells.pitch = means(first_known(motion.pitch, motion.attack), division, "the pitch");
  cells.heading = means(unwrapped(first_known(motion.heading, motion.ground_track)), division, "the heading");
  cells.sideslip = means(motion.sideslip, division, "the sideslip");
  cells.liquid_water = means(motion.liquid_water, division, "the liquid water");
  if (!has_value(cells.vertical_speed)) cells.vertical_speed = rate_of_change(cells.altitude, cells.begin);
  if (!has_value(cells.roll)) cells.roll = coordinated_roll(cells);
  for (double& speed : cells.vertical_speed) {
    if (std::abs(speed) > max_vertical_speed) speed = nan;
  }
  return cells;
}

}  // namespace pcor::internal
