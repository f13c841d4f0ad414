#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <pcor/residuals/samples.hpp>

namespace pcor {
class ModelOnSamples;
class ReferenceOnSamples;
}  // namespace pcor

namespace pcor::internal {

/// Masks that are independent of the model, from the motion of the flight and user exclusions: `excluded`,
/// `ground`, `low_speed`, `flaps`, `regime`, or `none`.
std::vector<Mask> masks_as_flown(const FlightSamples& samples, const MaskOptions& options);

/// Masks of a comparison of a model with a reference, for all reasons.
/// @param residual value of every sample, with the parameters of the files
std::vector<Mask> find_masks(const FlightSamples& samples, const ModelOnSamples& model,
                             const ReferenceOnSamples& reference, const std::vector<double>& residual,
                             const MaskOptions& options);

/// Whether an effect depends on the flaps. @param variable name of the flight's flaps variable, which a
/// formula may use
bool reads_flaps(const ModelEffect& effect, const std::string& variable);

/// Used samples: the first `share` of them, rounded.
std::vector<std::size_t> used_samples(const std::vector<Mask>& masks, double share = 1.0);

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

/// Samples with lost lock of the laser: its airspeed is far from the prediction by the pressures.
///
/// The model may be wrong by several m/s and the laser right, so the prediction comes from the flight: the
/// airspeed of the uncorrected pressures times a factor c0 + c1 p/q + c2 q/p, which follows a static defect
/// of usual shape, fitted robustly against up to half wrong samples. Further effects of attack, sideslip and
/// flaps are within 3 % of the airspeed. A sample is unlocked if it deviates by more than this and six robust
/// standard deviations, at least 0.1 m/s, the noise of a good laser at 1 Hz; if it is
/// 15 % or more from the median of the factor, beyond any static defect; or if most of the eleven samples
/// around it are unlocked.
///
/// @param beam speed along the beam, m/s @param airspeed of the uncorrected pressures, m/s
/// @param ratio measured q/p @param samples to examine
std::vector<std::size_t> find_unlocked(const std::vector<double>& beam, const std::vector<double>& airspeed,
                                       const std::vector<double>& ratio,
                                       const std::vector<std::size_t>& samples);

}  // namespace pcor::internal
