#include "residuals/flight_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include <pcor/base/utc.hpp>

namespace pcor::internal {

void FlightReport::add_flight(std::shared_ptr<const FlightSamples> samples,
                              std::vector<std::size_t> records) {
  flights_.push_back({std::move(samples), std::move(records)});
  const ShownFlight& flight = flights_.back();
  if (flight.records.empty()) return;
  report_.flight_starts.push_back(report_.time.size());
  report_.flight_names.push_back(flight.samples->name);
  const std::vector<double>& time = flight.samples->time;
  for (const std::size_t i : flight.records) report_.time.push_back(time[i]);
  for (const Interval& interval : flight.samples->intervals) {
    const bool is_met = std::any_of(flight.records.begin(), flight.records.end(), [&](std::size_t i) {
      return time[i] >= interval.begin && time[i] < interval.end;
    });
    if (is_met)
      report_.intervals.push_back({std::string(info_of(interval.regime).name), interval.begin, interval.end});
  }
}

bool FlightReport::add_motion(const std::string& name) {
  struct Motion {
    const char* name;
    const char* title;
    const char* unit;
    std::vector<double> FlightMotion::*series;
  };
  constexpr Motion motions[]{{"altitude", "altitude", "m", &FlightMotion::altitude},
                             {"attack", "angle of attack", "deg", &FlightMotion::attack},
                             {"ground_speed", "ground speed", "m/s", &FlightMotion::ground_speed},
                             {"pitch", "pitch", "deg", &FlightMotion::pitch},
                             {"roll", "roll", "deg", &FlightMotion::roll},
                             {"sideslip", "sideslip", "deg", &FlightMotion::sideslip},
                             {"true_airspeed", "true airspeed", "m/s", &FlightMotion::airspeed},
                             {"vertical_speed", "vertical speed", "m/s", &FlightMotion::vertical_speed}};
  const Motion& motion = *std::find_if(std::begin(motions), std::end(motions),
                                       [&name](const Motion& each) { return each.name == name; });
  return add_column(
      name, motion.title, motion.unit, flights_, [&motion](const ShownFlight& flight) -> const auto& {
        return flight.samples->motion.*motion.series;
      });
}

void FlightReport::add_position() {
  add_column(
      "latitude", "latitude", "deg", flights_,
      [](const ShownFlight& flight) -> const auto& { return flight.samples->latitude; });
  add_column(
      "longitude", "longitude", "deg", flights_,
      [](const ShownFlight& flight) -> const auto& { return flight.samples->longitude; });
}

void FlightReport::add_flights_to_info() {
  for (const ShownFlight& flight : flights_) {
    const std::vector<double>& time = flight.samples->time;
    if (time.empty()) continue;
    report_.info.emplace_back("Flight",
                              fmt::format("{}, {} to {} UTC", flight.samples->name, utc_text(time.front()),
                                          utc_text(time.back(), "%H:%M:%S")));
  }
}

}  // namespace pcor::internal
