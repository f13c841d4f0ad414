#pragma once

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "roles/recorded_series.hpp"

namespace pcor::internal {

/// Ground velocity, one value for each record; empty if the flight does not record it.
struct GroundVelocity {
  RecordedSeries speed{};  ///< m/s
  RecordedSeries track{};  ///< deg from true north
};

/// Reads ground speed and track, by the roles of the model or the standard names; otherwise the standard
/// components.
GroundVelocity read_ground_velocity(const Flight& flight, const ModelDefinition& model);

}  // namespace pcor::internal
