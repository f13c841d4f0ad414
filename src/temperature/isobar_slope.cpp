#include "temperature/isobar_slope.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace pcor {
namespace {

// In the order of the enumeration.
constexpr std::array<std::string_view, 5> slope_names{"fitted", "none", "level-legs", "climb-descent",
                                                      "whole-flight"};

}  // namespace

std::string_view to_string(IsobarSlope slope) { return slope_names.at(static_cast<std::size_t>(slope)); }

std::optional<IsobarSlope> isobar_slope_named(std::string_view name) {
  const auto found = std::find(slope_names.begin(), slope_names.end(), name);
  if (found == slope_names.end()) return std::nullopt;
  return static_cast<IsobarSlope>(found - slope_names.begin());
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
// 3 m in 100 km, a third of the usual slope.
constexpr double slope_fraction_after_estimate = 1.0 / 3.0;

/// Location with a known height of an isobaric surface, and the surface or leg that it belongs to.
struct Sighting {
  long group = 0;
  Eigen::Vector3d place;  // east, north, height
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
      if (is_level) result.push_back({leg, {block.east, block.north, height_at(block, leg_pressure)}});
      continue;
    }
    if (option == IsobarSlope::climb_descent && rate < climbing) continue;
    const long bin = std::lround(block.pressure / bin_hpa);
    result.push_back({bin, {block.east, block.north, height_at(block, bin_hpa * static_cast<double>(bin))}});
  }
  return result;
}

}  // namespace

Eigen::Vector2d estimate_isobar_slope(const HeightRecord& record, IsobarSlope option) {
  const std::vector<Sighting> all = sightings(record, option);
  std::map<long, Eigen::Vector4d> sums;  // place, and number
  for (const Sighting& s : all)
    sums.try_emplace(s.group, Eigen::Vector4d::Zero()).first->second += s.place.homogeneous();
  // The scatter of surfaces against their usual slope: a direction that is not flown stays level.
  Eigen::Matrix2d information =
      Eigen::Matrix2d::Identity() * (height_scatter * height_scatter / (usual_slope * usual_slope));
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (const Sighting& s : all) {
    const Eigen::Vector4d& sum = sums.at(s.group);
    if (sum[3] < 2.0) continue;
    const Eigen::Vector3d offset = s.place - sum.hnormalized();
    information += offset.head<2>() * offset.head<2>().transpose();
    right += offset.head<2>() * offset[2];
  }
  return information.inverse() * right;
}

void subtract_isobar_slope(HeightRecord& record, IsobarSlope option) {
  if (option == IsobarSlope::none) return;
  if (record.way == WayKnown::through_air) {
    record.notes.emplace_back(
        "airspeed and heading are used: ground speed and track are not recorded (GGSPD and GGTRK, or GGVEW "
        "and GGVNS)");
  }
  if (record.way == WayKnown::length) {
    record.notes.emplace_back(
        "errors in turns are not included: without ground velocity and heading, isobars are fitted along a "
        "straight track; not recorded: GGSPD and GGTRK, or GGVEW and GGVNS, or THDG");
  }
  if (option == IsobarSlope::fitted) return;
  if (record.way == WayKnown::length) {
    record.notes.emplace_back(
        "the slope of isobars is fitted by the likelihood, as with --slope fitted: directions are unknown");
    return;
  }
  record.slope_fraction = slope_fraction_after_estimate;
  const Eigen::Vector2d slope = estimate_isobar_slope(record, option);
  for (HeightBlock& block : record.blocks) block.excess -= slope[0] * block.east + slope[1] * block.north;
}

}  // namespace pcor::internal
