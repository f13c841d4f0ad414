#pragma once

#include <cstddef>
#include <vector>

namespace pcor::internal {

/// The samples at which a laser lost its lock: its airspeed is far from what the pressures let expect.
///
/// A model may be wrong by several m/s and the laser be right, so the expectation is made of the flight
/// itself: the airspeed of the uncorrected pressures times a factor c0 + c1 p/q + c2 q/p, which follows a
/// static defect of usual shape, fitted so that up to half of the samples may be astray. What attack,
/// sideslip and flaps do beyond that is within 3 % of the airspeed. Unlocked is what departs by more than
/// these 2 % and `max_departure` robust standard deviations, of which 0.1 m/s is the least, the noise of a
/// good laser at 1 Hz; what is 15 % or more from the median of the factor, which no static port explains; and
/// what lies among eleven samples of which most are so.
///
/// @param beam speed along the beam, m/s @param airspeed of the uncorrected pressures, m/s
/// @param ratio q/p as measured @param samples those that are looked at
std::vector<std::size_t> find_unlocked(const std::vector<double>& beam, const std::vector<double>& airspeed,
                                       const std::vector<double>& ratio,
                                       const std::vector<std::size_t>& samples, double max_departure);

}  // namespace pcor::internal
