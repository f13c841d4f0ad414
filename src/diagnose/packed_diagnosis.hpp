#pragma once

#include <pcor/diagnose/diagnose.hpp>
#include "residuals/packed_residuals.hpp"

/// Serialization of a flight's evidence and pictures for the other members of a team.
namespace cereal {

template <class Archive>
void serialize(Archive& archive, pcor::Evidence& evidence) {
  archive(evidence.flight, evidence.begin, evidence.end, evidence.regimes, evidence.share);
}

template <class Archive>
void serialize(Archive& archive, pcor::FlightDiagnosis& flight) {
  archive(flight.number, flight.name, flight.samples, flight.before, flight.after, flight.added,
          flight.evidence, flight.drift, flight.traced, flight.static_pressure, flight.mach, flight.attack,
          flight.sideslip);
}

}  // namespace cereal
