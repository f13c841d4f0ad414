#include "temperature/height_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <pcor/base/error.hpp>
#include <pcor/physics/constants.hpp>
#include <pcor/physics/hydrostatic.hpp>
#include <pcor/physics/moist_air.hpp>
#include "numerics/median.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr double min_height_range = 300.0;  // m
constexpr double kappa = 2.0 / 7.0;         // R/cp of dry air
constexpr double block_length = 10.0;       // s
/// s without pressure or temperature that the integral crosses in one step
constexpr double max_bridge = 10.0;

/// Integral at a sample in use.
struct Point {
  std::size_t sample = 0;
  bool starts_segment = false;
  double excess = 0.0;  // m
  HeightUnknowns columns;
};

/// The integral along a flight, sample by sample.
class Integration {
 public:
  Integration(const FlightAir& air, const std::vector<double>& steps, const HeightRecordOptions& options)
      : air_(air),
        steps_(steps),
        options_(options),
        attack_(options.has_radome ? air.attack_ratio : air.attack) {}

  std::vector<Point> run(HeightRecord& record) {
    const std::vector<RegimeSet> regimes = regimes_of_samples(air_.time(), air_.samples->intervals);
    std::vector<Point> points;
    HeightUnknowns squares = HeightUnknowns::Zero();  // squared change of static pressure for one unit, hPa2
    for (std::size_t i = 0; i < air_.size(); ++i) {
      // Without pressure it is not known to fly either: that is a gap, which `advance` may cross.
      const bool takes_part = air_.flying[i] && !regimes[i][static_cast<std::size_t>(Regime::take_off)];
      if (!takes_part && has_value(i)) {
        going_ = false;
        continue;
      }
      advance(i);
      if (!going_ || last_ != i) continue;
      if (std::isnan(air_.geopotential_height[i])) {
        ++record.missing_heights;
        continue;
      }
      points.push_back({i, starts_, air_.geopotential_height[i] - height_, columns_});
      squares += (last_shares_ * air_.pressure[i]).cwiseAbs2();
      starts_ = false;
    }
    const double count = std::max(1.0, static_cast<double>(points.size()));
    record.rms_of_unit = (squares / count).cwiseSqrt();
    return points;
  }

 private:
  bool has_value(std::size_t i) const {
    return !std::isnan(air_.pressure[i]) && !std::isnan(air_.temperature[i]);
  }

  /// Advances the integral to sample `i`; restarts after a gap.
  void advance(std::size_t i) {
    if (going_ && air_.time()[i] - air_.time()[last_] > max_bridge) going_ = false;
    if (!has_value(i)) return;
    const double step = going_ ? step_between(last_, i) : nan;
    if (std::isnan(step)) {
      starts_ = true;
      height_ = 0.0;
      columns_.setZero();
      last_shares_ = shares_at(i);
    } else {
      add_step(i, step);
    }
    going_ = true;
    last_ = i;
  }

  void add_step(std::size_t i, double step) {
    const double before = air_.temperature[last_] - constants::ice_point;
    const double here = air_.temperature[i] - constants::ice_point;
    const double mean = 0.5 * (before + here) + constants::ice_point;
    height_ += step * mean;
    add_errors(shares_at(i), step, mean, air_.gas_constant[i] * mean / constants::standard_gravity);
    // The thickness is proportional to R_a, whose excess over dry air is due to the vapour.
    const double dry =
        hydrostatic_step(air_.pressure[last_], air_.pressure[i], dry_air<double>().gas_constant);
    columns_[with_vapor] += (step - dry) * mean;
    double power_before = 1.0;
    double power_here = 1.0;
    for (Eigen::Index k = 0; k < lasting; ++k) {
      columns_[k] += step * 0.5 * (power_before + power_here);
      power_before *= before;
      power_here *= here;
    }
  }

  /// Relative pressure change of each error of one unit. If the angle is missing, its previous value is used.
  HeightUnknowns shares_at(std::size_t i) const {
    HeightUnknowns shares = last_shares_;
    shares[lasting] = 1.0 / air_.pressure[i];
    shares[with_static] = 1.0;
    const double by_dynamic = air_.dynamic[i] / air_.pressure[i];
    if (!std::isnan(by_dynamic)) shares[with_dynamic] = by_dynamic;
    if (!attack_.empty() && !std::isnan(attack_[i])) shares[with_attack] = attack_[i];
    return shares;
  }

  void add_errors(const HeightUnknowns& shares, double step, double temperature, double scale_height) {
    columns_ += scale_height * (shares - last_shares_);
    // The static correction is subtracted from the dynamic pressure, and therefore changes the dynamic
    // heating.
    if (options_.recovers) {
      for (const HeightError k : {with_static, with_dynamic, with_attack})
        columns_[k] -= step * temperature * kappa * 0.5 * (shares[k] + last_shares_[k]);
    }
    last_shares_ = shares;
  }

  double step_between(std::size_t before, std::size_t here) const {
    if (!steps_.empty()) {
      double sum = 0.0;
      for (std::size_t i = before + 1; i <= here; ++i) sum += steps_[i];
      if (!std::isnan(sum)) return sum;  // bridges samples without pressure
    }
    return hydrostatic_step(air_.pressure[before], air_.pressure[here],
                            0.5 * (air_.gas_constant[before] + air_.gas_constant[here]));
  }

  const FlightAir& air_;
  const std::vector<double>& steps_;
  const HeightRecordOptions& options_;
  const std::vector<double>& attack_;
  bool going_ = false;
  bool starts_ = false;
  std::size_t last_ = 0;
  double height_ = 0.0;
  HeightUnknowns columns_ = HeightUnknowns::Zero();
  HeightUnknowns last_shares_ = HeightUnknowns::Zero();
};

/// Marks GPS errors that are impossible motions: spikes are excluded, and the integral restarts at a step.
void mark_steps(std::vector<Point>& points, HeightRecord& record) {
  constexpr double min_step = 5.0;     // m; smaller ones are part of the noise model
  constexpr double deviations = 10.0;  // robust standard deviations of a change within a second
  constexpr std::size_t max_spike = 60;
  std::vector<double> changes;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (!points[i].starts_segment) changes.push_back(std::abs(points[i].excess - points[i - 1].excess));
  }
  const double limit = std::max(min_step, deviations * 1.4826 * median(changes));
  std::vector<Point> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Point point = points[i];
    if (!point.starts_segment && !kept.empty() && std::abs(point.excess - kept.back().excess) > limit) {
      std::size_t end = i + 1;
      const auto may_come_back = [&] {
        return end < points.size() && end - i < max_spike && !points[end].starts_segment;
      };
      while (may_come_back() && std::abs(points[end].excess - kept.back().excess) > limit) ++end;
      if (may_come_back()) {
        record.height_spikes += end - i;
        i = end - 1;
        continue;
      }
      point.starts_segment = true;
      ++record.height_steps;
    }
    kept.push_back(point);
  }
  points = std::move(kept);
}

WayKnown way_known(const FlightAir& air) {
  if (!air.east_speed.empty()) return WayKnown::over_ground;
  return air.samples->motion.heading.empty() ? WayKnown::length : WayKnown::through_air;
}

bool has_ground_velocity(const FlightAir& air, std::size_t i) {
  return !air.east_speed.empty() && !std::isnan(air.east_speed[i] + air.north_speed[i]);
}

/// Ground velocity to the east and north, m/s; if missing, velocity through the air from airspeed and
/// heading. Without any heading or track, the airspeed counts as northward. NaN if unknown.
Eigen::Vector2d velocity(const FlightAir& air, std::size_t i) {
  if (has_ground_velocity(air, i)) return {air.east_speed[i], air.north_speed[i]};
  if (way_known(air) == WayKnown::length) return {0.0, air.airspeed[i]};
  const std::vector<double>& headings = air.samples->motion.heading;
  if (headings.empty()) return {nan, nan};
  const double heading = headings[i] * constants::radians_per_degree;
  return {air.airspeed[i] * std::sin(heading), air.airspeed[i] * std::cos(heading)};
}

/// Displacement from the first sample to each, m, to the east and north. Missing velocities are replaced by
/// the last one.
std::vector<Eigen::Vector2d> way_flown(const FlightAir& air) {
  std::vector<Eigen::Vector2d> way(air.size(), Eigen::Vector2d::Zero());
  Eigen::Vector2d last = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < air.size(); ++i) {
    Eigen::Vector2d now = velocity(air, i);
    if (now.hasNaN()) now = last;
    if (i > 0) way[i] = way[i - 1] + 0.5 * (last + now) * (air.time()[i] - air.time()[i - 1]);
    last = now;
  }
  return way;
}

using PointIterator = std::vector<Point>::const_iterator;

/// Means over consecutive points.
HeightBlock block_of(const FlightAir& air, const std::vector<Eigen::Vector2d>& way, PointIterator first,
                     PointIterator end) {
  HeightBlock block;
  block.starts_segment = first->starts_segment;
  block.samples = static_cast<std::size_t>(end - first);
  const double start_time = air.time()[first->sample];
  for (auto point = first; point != end; ++point) {
    const std::size_t i = point->sample;
    block.time += air.time()[i] - start_time;
    block.excess += point->excess;
    block.columns += point->columns;
    block.east += way[i][0];
    block.north += way[i][1];
    block.height += air.geopotential_height[i];
    block.pressure += air.pressure[i];
    block.temperature += air.temperature[i] - constants::ice_point;
  }
  const auto n = static_cast<double>(block.samples);
  for (double* value : {&block.time, &block.excess, &block.east, &block.north, &block.height, &block.pressure,
                        &block.temperature})
    *value /= n;
  block.columns /= n;
  block.time += start_time;
  block.length = n * air.step();
  const double kelvin = block.temperature + constants::ice_point;
  block.metres_per_hpa =
      air.gas_constant[(end - 1)->sample] * kelvin / (constants::standard_gravity * block.pressure);
  return block;
}

/// Removes blocks with slow climb; the remaining parts of a climb are segments.
void keep_climbs(std::vector<HeightBlock>& blocks, double min_rate) {
  if (min_rate <= 0.0) return;
  std::vector<HeightBlock> kept;
  double last = 0.0;  // direction of the block before; 0 if it is removed
  for (HeightBlock block : blocks) {
    const double direction = std::abs(block.climb) >= min_rate ? std::copysign(1.0, block.climb) : 0.0;
    if (direction != 0.0) {
      block.starts_segment = block.starts_segment || direction != last;
      kept.push_back(block);
    }
    last = direction;
  }
  blocks = std::move(kept);
}

void find_climbs(std::vector<HeightBlock>& blocks) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const std::size_t before = blocks[i].starts_segment ? i : i - 1;
    const std::size_t after = i + 1 < blocks.size() && !blocks[i + 1].starts_segment ? i + 1 : i;
    if (after == before) continue;
    blocks[i].climb =
        (blocks[after].height - blocks[before].height) / (blocks[after].time - blocks[before].time);
  }
}

}  // namespace

HeightRecord height_record(const FlightAir& air, const std::vector<double>& steps,
                           const HeightRecordOptions& options) {
  const std::string& name = air.samples->name;
  if (air.temperature.empty()) {
    throw Error(
        Error::Code::model,
        fmt::format("{}: the model names no thermometer; give it recovery_temperature or ambient_temperature "
                    "in the table [variables]",
                    name));
  }
  if (const std::string problem = height_problem(air); !problem.empty())
    throw Error(Error::Code::variable, fmt::format("{}: {}", name, problem));

  HeightRecord record;
  record.name = name;
  record.notes = air.notes;
  std::vector<Point> points = Integration(air, steps, options).run(record);
  mark_steps(points, record);
  if (points.empty())
    throw Error(
        Error::Code::variable,
        fmt::format("{}: no sample has pressures, temperature and height; 'pcor inspect' lists variables "
                    "without usable values",
                    name));

  record.way = way_known(air);
  const std::vector<Eigen::Vector2d> way = way_flown(air);
  auto begin = points.cbegin();
  for (auto point = begin; point != points.cend(); ++point) {
    const bool is_full =
        air.time()[point->sample] - air.time()[begin->sample] >= block_length - 0.5 * air.step();
    if (point != begin && (point->starts_segment || is_full)) {
      record.blocks.push_back(block_of(air, way, begin, point));
      begin = point;
    }
    if (record.way == WayKnown::over_ground && !has_ground_velocity(air, point->sample))
      ++record.unknown_ways;
  }
  record.blocks.push_back(block_of(air, way, begin, points.end()));
  find_climbs(record.blocks);
  keep_climbs(record.blocks, options.min_climb_rate);

  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  record.min_temperature = lowest;
  record.max_temperature = highest;
  for (const HeightBlock& block : record.blocks) {
    record.segments += block.starts_segment ? 1 : 0;
    record.samples += block.samples;
    lowest = std::min(lowest, block.height);
    highest = std::max(highest, block.height);
    record.min_temperature = std::min(record.min_temperature, block.temperature);
    record.max_temperature = std::max(record.max_temperature, block.temperature);
  }
  if (!(highest - lowest >= min_height_range)) {
    throw Error(
        Error::Code::samples,
        fmt::format(
            "{}: climbs and descents span {:.0f} m{}; a fit of temperature needs {:.0f} m", name,
            record.blocks.empty() ? 0.0 : highest - lowest,
            options.min_climb_rate > 0.0 ? fmt::format(" at {} m/s or more", options.min_climb_rate) : "",
            min_height_range));
  }
  if (record.way == WayKnown::over_ground) {
    const HeightBlock& first = record.blocks.front();
    const HeightBlock& last = record.blocks.back();
    constexpr double near = 5e4;  // m
    record.returns = std::hypot(last.east - first.east, last.north - first.north) < near;
  }
  return record;
}

}  // namespace pcor::internal
