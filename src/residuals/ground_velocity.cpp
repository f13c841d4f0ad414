#include "residuals/ground_velocity.hpp"

#include <cmath>

#include <pcor/physics/constants.hpp>
#include "roles/recorded_series.hpp"

namespace pcor::internal {

GroundVelocity read_ground_velocity(const Flight& flight, const ModelFile& model) {
  const std::vector<double> speed = read_role(flight, model, Quantity::ground_speed).values;
  const std::vector<double> track = read_role(flight, model, Quantity::ground_track).values;
  GroundVelocity velocity;
  if (speed.empty() || track.empty()) {
    velocity.east = read_usual(flight, usual_series("ground_speed_east")).values;
    velocity.north = read_usual(flight, usual_series("ground_speed_north")).values;
    if (velocity.east.empty() || velocity.north.empty()) return {};
    return velocity;
  }
  for (std::size_t i = 0; i < speed.size(); ++i) {
    const double angle = track[i] * constants::radians_per_degree;
    velocity.east.push_back(speed[i] * std::sin(angle));
    velocity.north.push_back(speed[i] * std::cos(angle));
  }
  return velocity;
}

}  // namespace pcor::internal
