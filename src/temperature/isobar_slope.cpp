#include "temperature/isobar_slope.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <pcor/physics/geodesy.hpp>

namespace pcor {
namespace {

constexpr std::array<std::pair<IsobarSlope, std::string_view>, 6> slope_names{{
    {IsobarSlope::fitted, "fitted"},
    {IsobarSlope::none, "none"},
    {IsobarSlope::level_legs, "level-legs"},
    {IsobarSlope::climb_descent, "climb-descent"},
    {IsobarSlope::whole_flight, "whole-flight"},
    {IsobarSlope::geostrophic, "geostrophic"},
}};

}  // namespace

std::string_view to_string(IsobarSlope slope) {
  return std::find_if(slope_names.begin(), slope_names.end(),
                      [slope](const auto& each) { return each.first == slope; })
      ->second;
}

std::optional<IsobarSlope> isobar_slope_named(std::string_view name) {
  for (const auto& [slope, slope_name] : slope_names) {
    if (slope_name == name) return slope;
  }
  return std::nullopt;
}

}  // namespace pcor

namespace pcor::internal {
namespace {

constexpr double level_climb = 1.0;     // m/s: slower is level
constexpr double climbing = 1.5;        // m/s: faster is a climb or a descent
constexpr double bin_hpa = 10.0;        // bin width of isobaric surfaces crossed more than once
constexpr double usual_slope = 1e-4;    // 10 m in 100 km; memo after eq. 24
constexpr double height_scatter = 2.0;  // m, of surfaces about a plane

// Estimates use surfaces that are crossed again a few 10 km away, with a scatter of metres: an error of about
// 3 m in 100 km, a third of the usual slope. A wind is out of balance by a similar fraction.
constexpr double slope_left_by_estimates = 1.0 / 3.0;

/// Location with a known height of an isobaric surface, and the surface or leg that it belongs to.
struct Sighting {
  long group = 0;
  double east = 0.0;
  double north = 0.0;
  double height = 0.0;
};

double height_at(const HeightBlock& block, double pressure) {
  // metres_per_hpa is R_a T/(g p): the thickness to a surface nearby.
  return block.height + block.metres_per_hpa * block.pressure * std::log(block.pressure / pressure);
}

std::vector<Sighting> sightings(const HeightRecord& record, IsobarSlope option) {
  std::vector<Sighting> result;
  long leg = 0;
  double leg_pressure = 0.0;
  bool was_level = false;
  for (const HeightBlock& block : record.blocks) {
    const double rate = std::abs(block.climb);
    if (option == IsobarSlope::level_legs) {
      const bool is_level = rate < level_climb;
      if (is_level && (!was_level || std::abs(block.pressure - leg_pressure) > bin_hpa)) {
        ++leg;
        leg_pressure = block.pressure;
      }
      was_level = is_level;
      if (is_level) result.push_back({leg, block.east, block.north, height_at(block, leg_pressure)});
      continue;
    }
    if (option == IsobarSlope::climb_descent && rate < climbing) continue;
    const long bin = std::lround(block.pressure / bin_hpa);
    result.push_back({bin, block.east, block.north, height_at(block, bin_hpa * static_cast<double>(bin))});
  }
  return result;
}

}  // namespace

IsobarSlopeEstimate estimate_isobar_slope(const HeightRecord& record, IsobarSlope option) {
  const std::vector<Sighting> all = sightings(record, option);
  std::map<long, Eigen::Vector4d> sums;  // east, north, height, number
  for (const Sighting& s : all) {
    Eigen::Vector4d& sum = sums.try_emplace(s.group, Eigen::Vector4d::Zero()).first->second;
    sum += Eigen::Vector4d(s.east, s.north, s.height, 1.0);
  }
  IsobarSlopeEstimate result;
  // The scatter of surfaces against their usual slope: a direction that is not flown stays level.
  Eigen::Matrix2d information =
      Eigen::Matrix2d::Identity() * (height_scatter * height_scatter / (usual_slope * usual_slope));
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (const Sighting& s : all) {
    const Eigen::Vector4d& sum = sums.at(s.group);
    if (sum[3] < 2.0) continue;
    const Eigen::Vector2d offset(s.east - sum[0] / sum[3], s.north - sum[1] / sum[3]);
    information += offset * offset.transpose();
    right += offset * (s.height - sum[2] / sum[3]);
    ++result.blocks;
  }
  const Eigen::Vector2d slope = information.ldlt().solve(right);
  result.east = slope[0];
  result.north = slope[1];
  return result;
}

void take_off_isobar_slope(HeightRecord& record, IsobarSlope option) {
  if (option == IsobarSlope::none) return;
  if (record.way == WayKnown::through_air) {
    record.notes.emplace_back(
        "ground speed and track are not recorded (GGSPD and GGTRK, or GGVEW and GGVNS): airspeed and heading "
        "are used instead");
  }
  if (record.way == WayKnown::length) {
    record.notes.emplace_back(
        "neither ground speed and track nor heading is recorded (GGSPD and GGTRK, or GGVEW and GGVNS, or "
        "THDG): the slope of isobars is fitted as if the track were straight, so errors in turns are not "
        "included");
  }
  if (option == IsobarSlope::fitted) return;
  if (option == IsobarSlope::geostrophic && !record.has_wind) {
    record.notes.emplace_back(
        "no wind, because heading, airspeed or ground velocity is not recorded: the slope of isobars is "
        "fitted by the likelihood, as with --slope fitted");
    return;
  }
  if (option != IsobarSlope::geostrophic && record.way == WayKnown::length) {
    record.notes.emplace_back(
        "no slope of isobars can be estimated, because directions are unknown: it is fitted by the "
        "likelihood, as with --slope fitted");
    return;
  }
  record.slope_left = slope_left_by_estimates;
  if (option == IsobarSlope::geostrophic) {
    double rise = 0.0;
    for (std::size_t i = 1; i < record.blocks.size(); ++i) {
      HeightBlock& here = record.blocks[i];
      const HeightBlock& before = record.blocks[i - 1];
      rise += 0.5 * ((before.slope_east + here.slope_east) * (here.east - before.east) +
                     (before.slope_north + here.slope_north) * (here.north - before.north));
      here.excess -= rise;
    }
    return;
  }
  const IsobarSlopeEstimate slope = estimate_isobar_slope(record, option);
  for (HeightBlock& block : record.blocks)
    block.excess -= slope.east * block.east + slope.north * block.north;
}

}  // namespace pcor::internal
