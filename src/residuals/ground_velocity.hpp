#pragma once

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "roles/recorded_series.hpp"

namespace pcor::internal {

/// The velocity over the ground, one value for each record; without values where the flight does not record
/// it.
struct GroundVelocity {
  RecordedSeries speed{};  ///< m/s
  RecordedSeries track{};  ///< deg from true north
};

/// From ground speed and track, by the roles of the model or the usual names; else from the usual components.
GroundVelocity read_ground_velocity(const Flight& flight, const ModelDefinition& model);

}  // namespace pcor::internal
