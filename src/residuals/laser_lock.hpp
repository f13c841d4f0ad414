#pragma once

#include <cstddef>
#include <vector>

namespace pcor::internal {

/// Samples with lost lock of the laser: its airspeed is far from the prediction by the pressures.
///
/// The model may be wrong by several m/s and the laser right, so the prediction comes from the flight: the
/// airspeed of the uncorrected pressures times a factor c0 + c1 p/q + c2 q/p, which follows a static defect
/// of usual shape, fitted robustly against up to half wrong samples. Further effects of attack, sideslip and
/// flaps are within 3 % of the airspeed. A sample is unlocked if it deviates by more than this and
/// `max_departure` robust standard deviations, at least 0.1 m/s, the noise of a good laser at 1 Hz; if it is
/// 15 % or more from the median of the factor, beyond any static defect; or if most of the eleven samples
/// around it are unlocked.
///
/// @param beam speed along the beam, m/s @param airspeed of the uncorrected pressures, m/s
/// @param ratio measured q/p @param samples to examine
std::vector<std::size_t> find_unlocked(const std::vector<double>& beam, const std::vector<double>& airspeed,
                                       const std::vector<double>& ratio,
                                       const std::vector<std::size_t>& samples, double max_departure);

}  // namespace pcor::internal
