#pragma once

#include <cstddef>
#include <vector>

namespace pcor::internal {

/// Samples of bursts: for at most 20 s a pressure jumps, and the residual with it.
///
/// A jump is a sample that deviates from the mean of its neighbours by more than five robust standard
/// deviations of its five minutes; samples within 20 s that deviate by three belong to it. Gusts and
/// manoeuvres cause a pressure jump that the reference shows as well, so that the residual does not jump; an
/// effect changes the residual while the pressure is smooth. Only if both jump, and neither jumps within 20 s
/// before and after, the pressure was disturbed.
///
/// @param residual NaN where not used @param pressures as recorded, of as many samples
/// @param time s @param step usual sampling interval, s
std::vector<std::size_t> find_bursts(const std::vector<double>& residual,
                                     const std::vector<const std::vector<double>*>& pressures,
                                     const std::vector<double>& time, double step);

}  // namespace pcor::internal
