#pragma once

#include <cstddef>
#include <vector>

namespace pcor::internal {

/// The samples of bursts: for 20 s at most a pressure jumps, and the residual with it.
///
/// A jump is a sample that departs from the middle of its neighbours by more than five robust deviations of
/// its five minutes; what does so by three within 20 s of it belongs to it. Gusts and manoeuvres make a
/// pressure jump that the reference feels as well, so that the residual does not; an effect changes the
/// residual where the pressure goes on smoothly. Only where both jump, and nothing of it within 20 s before
/// and after, the pressure was disturbed.
///
/// @param residual NaN where not used @param pressures as recorded, of as many samples
/// @param time s @param step the usual step, s
std::vector<std::size_t> find_bursts(const std::vector<double>& residual,
                                     const std::vector<const std::vector<double>*>& pressures,
                                     const std::vector<double>& time, double step);

}  // namespace pcor::internal
