#pragma once

#include <pcor/base/note.hpp>
#include <pcor/residuals/samples.hpp>

#include <string>
#include <vector>

namespace pcor::internal {

/// Recorded series with contradictory signs: series that should increase together change in opposite
/// directions, such as the vertical speed and the altitude if one is positive downward, or the heading and
/// the ground track if one is counted in the opposite direction. A sentence for each pair, without full stop.
///
/// The pairs are compared over 10 s in the air; they contradict each other if their correlation is below -0.5
/// in at least ten minutes in which both moved. A missing series is not compared.
/// @param min_airspeed m/s; slower samples are not used
Notes contradicting_signs(const FlightSamples& samples, double min_airspeed);

}  // namespace pcor::internal
