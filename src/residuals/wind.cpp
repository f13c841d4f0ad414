#include "residuals/wind.hpp"

#include <cmath>
#include <cstddef>

#include <pcor/physics/constants.hpp>

namespace pcor::internal {

std::vector<ReportBarb> wind_of(const FlightSamples& flight) {
  constexpr double barbs = 40.0;
  const FlightMotion& motion = flight.motion;
  std::vector<ReportBarb> wind;
  if (motion.airspeed.empty() || motion.heading.empty() || motion.ground_speed.empty() ||
      motion.ground_track.empty())
    return wind;
  const double apart = (flight.time.back() - flight.time.front()) / barbs;
  for (std::size_t i = 0; i < flight.time.size(); ++i) {
    if (!wind.empty() && flight.time[i] - wind.back().time < apart) continue;
    const bool slips = !motion.sideslip.empty() && std::isfinite(motion.sideslip[i]);
    const double ahead =
        (motion.heading[i] + (slips ? motion.sideslip[i] : 0.0)) * constants::radians_per_degree;
    const double track = motion.ground_track[i] * constants::radians_per_degree;
    const ReportBarb barb{flight.time[i],
                          motion.ground_speed[i] * std::sin(track) - motion.airspeed[i] * std::sin(ahead),
                          motion.ground_speed[i] * std::cos(track) - motion.airspeed[i] * std::cos(ahead)};
    if (std::isfinite(barb.east) && std::isfinite(barb.north)) wind.push_back(barb);
  }
  return wind;
}

}  // namespace pcor::internal
