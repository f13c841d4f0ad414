#pragma once

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "roles/jumps.hpp"
#include "roles/recorded_series.hpp"

namespace pcor::internal {

/// Ground velocity, one value for each record; empty if the flight does not record it.
struct GroundVelocity {
  RecordedSeries speed{};  ///< m/s
  RecordedSeries track{};  ///< deg from true north
  /// Samples that are masked: where a component jumps, m/s, or departs from the positions' own rate.
  std::vector<Jump> jumps{};
  std::vector<Jump> against_position{};
};

/// Reads ground speed and track, by the roles of the model or the standard names; otherwise the standard
/// components. Samples that jump, or contradict the positions by more than 15 m/s for 3 samples or
/// more, are missing.
GroundVelocity read_ground_velocity(const Flight& flight, const ModelDefinition& model);

/// The coordinates of a flight and their jumps.
struct Positions {
  RecordedSeries latitude{};            ///< deg; its jumps are missing
  RecordedSeries longitude{};           ///< deg; its jumps are missing
  std::vector<Jump> latitude_jumps{};   ///< m
  std::vector<Jump> longitude_jumps{};  ///< m
};

Positions read_positions(const Flight& flight, const ModelDefinition& model, const std::vector<double>& time);

}  // namespace pcor::internal
