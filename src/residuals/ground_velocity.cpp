#include "residuals/ground_velocity.hpp"

#include <algorithm>
#include <cmath>

#include <pcor/physics/constants.hpp>
#include "numerics/median.hpp"
#include "numerics/missing.hpp"
#include "regimes/series.hpp"

namespace pcor::internal {
namespace {

constexpr double metres_per_degree = 6371000.0 * constants::radians_per_degree;
constexpr double degree = constants::radians_per_degree;

GroundVelocity read_as_recorded(const Flight& flight, const ModelDefinition& model) {
  GroundVelocity velocity{read_role(flight, model, Quantity::ground_speed),
                          read_role(flight, model, Quantity::ground_track)};
  if (!velocity.speed.values.empty() && !velocity.track.values.empty()) return velocity;
  const VariableNaming& naming = naming_of(model, flight);
  const RecordedSeries east = read_usual(flight, naming, "ground_speed_east");
  const RecordedSeries north = read_usual(flight, naming, "ground_speed_north");
  if (east.values.empty() || north.values.empty()) return {};
  const std::string both = east.variable + " and " + north.variable;
  velocity = {{both}, {both}};
  for (std::size_t i = 0; i < east.values.size(); ++i) {
    velocity.speed.values.push_back(std::hypot(east.values[i], north.values[i]));
    velocity.track.values.push_back(std::atan2(east.values[i], north.values[i]) / degree);
  }
  return velocity;
}

/// The jumps of a coordinate, in metres; those samples are missing afterwards. A longitude is continued
/// across the date line.
std::vector<Jump> take_jumps_out(std::vector<double>& coordinate, const std::vector<double>& time,
                                 double metres) {
  std::vector<double> path = unwrapped(coordinate);
  for (double& each : path) each *= metres;
  std::vector<Jump> jumps = find_jumps(path, time, min_position_rate);
  mask(jumps, coordinate);
  return jumps;
}

/// Where a velocity departs from that of the positions for three samples and more.
std::vector<Jump> contradictions(const std::vector<double>& east, const std::vector<double>& north,
                                 const Positions& positions, const std::vector<double>& time) {
  constexpr double min_departure = 15.0;  // m/s: positions of 10 m give 5
  constexpr double deviations = 8.0;
  const std::vector<double>& latitude = positions.latitude.values;
  const std::vector<double>& longitude = positions.longitude.values;
  if (latitude.size() != time.size() || longitude.size() != time.size()) return {};
  std::vector<double> departure(time.size(), nan);
  for (std::size_t i = 1; i + 1 < time.size(); ++i) {
    const double elapsed = time[i + 1] - time[i - 1];
    const double by_north = metres_per_degree * (latitude[i + 1] - latitude[i - 1]) / elapsed;
    const double by_east = metres_per_degree * std::cos(latitude[i] * degree) *
                           std::remainder(longitude[i + 1] - longitude[i - 1], 360.0) / elapsed;
    departure[i] = std::hypot(by_east - east[i], by_north - north[i]);
  }
  // Where they differ all the time it is a matter of units, and no fault.
  const double usual = median(departure);
  const double limit = std::max(min_departure, deviations * usual);
  if (!(usual < min_departure)) return {};
  std::vector<Jump> found;
  for (const IndexRange& run :
       drop_short(runs_where(departure.size(), [&](std::size_t i) { return departure[i] > limit; }), 3))
    found.push_back({run.first, run.length(), extent(departure, run).maximum});
  return found;
}

}  // namespace

Positions read_positions(const Flight& flight, const ModelDefinition& model,
                         const std::vector<double>& time) {
  Positions positions{read_role(flight, model, Quantity::latitude), read_longitude(flight, model)};
  const double middle = median(positions.latitude.values);
  positions.latitude_jumps = take_jumps_out(positions.latitude.values, time, metres_per_degree);
  positions.longitude_jumps =
      take_jumps_out(positions.longitude.values, time, metres_per_degree * std::cos(middle * degree));
  return positions;
}

GroundVelocity read_ground_velocity(const Flight& flight, const ModelDefinition& model) {
  GroundVelocity velocity = read_as_recorded(flight, model);
  if (velocity.speed.values.empty()) return velocity;
  const std::vector<double> time = record_times(flight);
  std::vector<double> east;
  std::vector<double> north;
  for (std::size_t i = 0; i < velocity.speed.values.size(); ++i) {
    east.push_back(velocity.speed.values[i] * std::sin(velocity.track.values[i] * degree));
    north.push_back(velocity.speed.values[i] * std::cos(velocity.track.values[i] * degree));
  }
  for (std::vector<double>* const component : {&east, &north}) {
    for (const Jump& jump : find_jumps(*component, time, min_velocity_rate)) velocity.jumps.push_back(jump);
  }
  std::sort(velocity.jumps.begin(), velocity.jumps.end(),
            [](const Jump& a, const Jump& b) { return a.first < b.first; });
  for (std::vector<double>* const component : {&east, &north}) mask(velocity.jumps, *component);
  velocity.against_position = contradictions(east, north, read_positions(flight, model, time), time);
  for (const auto* const faults : {&velocity.jumps, &velocity.against_position}) {
    mask(*faults, velocity.speed.values);
    mask(*faults, velocity.track.values);
  }
  return velocity;
}

}  // namespace pcor::internal
