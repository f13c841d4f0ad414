#pragma once

#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/laws/model_file.hpp>

namespace pcor::internal {

/// The velocity over the ground, m/s, one value for each record; empty where the flight does not record it.
struct GroundVelocity {
  std::vector<double> east{};
  std::vector<double> north{};
};

/// From ground speed and track, by the roles of the model or the usual names; else from the usual components.
GroundVelocity read_ground_velocity(const Flight& flight, const ModelFile& model);

}  // namespace pcor::internal
