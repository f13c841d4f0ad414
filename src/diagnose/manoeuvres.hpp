#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pcor/residuals/residuals.hpp>

namespace pcor::internal {

/// A manoeuvre that could be flown, as the aircraft of some flights would record it.
struct Manoeuvre {
  std::string name;       ///< e.g. "yaw manoeuvre"
  std::string how;        ///< what to do, e.g. "12 cycles of 12 s, sideslip +-4 deg, at 3000 m and 115 m/s"
  double duration = 0.0;  ///< s
  /// Noise-free samples at the step of the flights, with every quantity that the flights' samples have.
  std::shared_ptr<const FlightSamples> samples;
};

/// About fifteen manoeuvres that tell effects apart, flown by the aircraft of `flights` at its usual weight
/// and heights.
///
/// What is not known of an aircraft is learnt from its flights: the levels that it flies at, how the angle of
/// attack follows load and dynamic pressure, how the radome's pressures follow the angles, how moist the air
/// is and how warm at which height, cabin pressure and bay temperature with height. A manoeuvre is left out
/// where the flights do not teach what it needs.
std::vector<Manoeuvre> standard_manoeuvres(const std::vector<std::shared_ptr<const FlightSamples>>& flights);

}  // namespace pcor::internal
