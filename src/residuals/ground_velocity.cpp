#include "residuals/ground_velocity.hpp"

#include <cmath>

#include <pcor/physics/constants.hpp>

namespace pcor::internal {

GroundVelocity read_ground_velocity(const Flight& flight, const ModelDefinition& model) {
  GroundVelocity velocity{read_role(flight, model, Quantity::ground_speed),
                          read_role(flight, model, Quantity::ground_track)};
  if (!velocity.speed.values.empty() && !velocity.track.values.empty()) return velocity;
  const VariableNaming& family = family_of(model, flight);
  const RecordedSeries east = read_usual(flight, family, "ground_speed_east");
  const RecordedSeries north = read_usual(flight, family, "ground_speed_north");
  if (east.values.empty() || north.values.empty()) return {};
  const std::string both = east.variable + " and " + north.variable;
  velocity = {{both}, {both}};
  for (std::size_t i = 0; i < east.values.size(); ++i) {
    velocity.speed.values.push_back(std::hypot(east.values[i], north.values[i]));
    velocity.track.values.push_back(std::atan2(east.values[i], north.values[i]) /
                                    constants::radians_per_degree);
  }
  return velocity;
}

}  // namespace pcor::internal
