#pragma once

#include <pcor/residuals/samples.hpp>

#include <string>
#include <vector>

namespace pcor::internal {

/// Which recorded series contradict each other in sign: what must go up together goes in opposite directions,
/// as the vertical speed and the altitude where one is positive downward, or the heading and the ground track
/// where one is counted the other way round. A sentence for each pair, without full stop.
///
/// The pairs are compared over 10 s in the air; they contradict each other where their correlation is below
/// -0.5 in at least ten minutes in which both moved. A series that is absent contradicts nothing.
/// @param min_airspeed m/s; slower samples do not count
std::vector<std::string> contradicting_signs(const FlightSamples& samples, double min_airspeed);

}  // namespace pcor::internal
