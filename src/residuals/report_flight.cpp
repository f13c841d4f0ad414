#include "residuals/report_flight.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <pcor/physics/constants.hpp>

namespace pcor::internal {

void add_flight(Report& report, const FlightSamples& flight, const std::vector<std::size_t>& records) {
  report.flight_starts.push_back(report.time.size());
  report.flight_names.push_back(flight.name);
  for (const std::size_t i : records) report.time.push_back(flight.time[i]);
  for (const Interval& interval : flight.intervals) {
    const bool met = std::any_of(records.begin(), records.end(), [&](std::size_t i) {
      return flight.time[i] >= interval.begin && flight.time[i] < interval.end;
    });
    if (met)
      report.intervals.push_back({std::string(info_of(interval.regime).name), interval.begin, interval.end});
  }
}

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
