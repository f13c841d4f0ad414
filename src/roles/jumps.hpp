#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace pcor::internal {

/// Samples between a jump away from where a series was and the jump back.
struct Jump {
  std::size_t first = 0;
  std::size_t count = 0;
  double size = 0.0;  ///< the largest departure from a line across
};

/// Rates that no gust and no turn reaches, of the value per second, between one sample and the next.
inline constexpr double min_height_rate = 20.0;     ///< m/s
inline constexpr double min_velocity_rate = 12.0;   ///< m/s2, of a component over the ground
inline constexpr double min_position_rate = 100.0;  ///< m/s, of a coordinate

/// Where a series leaves its path and returns within a minute: its rate departs from that of the seconds
/// around by eight of its robust deviations and by more than `min_rate`. @param time s
std::vector<Jump> find_jumps(const std::vector<double>& values, const std::vector<double>& time,
                             double min_rate = min_height_rate);

/// Makes them missing.
void mask(const std::vector<Jump>& jumps, std::vector<double>& values);

/// "GGALT jumps by up to 320 m from 2015-07-29 19:11:00 to 19:11:03 UTC (4 samples)".
std::string format_jump(const std::string& variable, const Jump& jump, const std::vector<double>& time,
                        const std::string& unit = "m");

}  // namespace pcor::internal
