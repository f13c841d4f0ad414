#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

class ModelOnSamples;
class ReferenceOnSamples;

/// Masks that are independent of the model, from the motion of the flight and user exclusions: `excluded`,
/// `ground`, `low_speed`, `flaps`, `regime`, or `none`.
std::vector<Mask> masks_as_flown(const FlightSamples& samples, const MaskOptions& options);

/// Inputs of the masks of a comparison of a model with a reference.
struct MaskedResidual {
  const FlightSamples& samples;
  const ModelOnSamples& model;
  const ReferenceOnSamples& reference;
  const std::vector<double>& values;  ///< value of every sample, with the parameters of the files
};

/// Masks for all reasons.
std::vector<Mask> find_masks(const MaskedResidual& residual, const MaskOptions& options);

/// Whether an effect depends on the flaps. @param variable name of the flight's flaps variable, which a
/// formula may use
bool reads_flaps(const ModelEffect& effect, const std::string& variable);

/// Used samples: the first `share` of them, rounded.
std::vector<std::size_t> used_samples(const std::vector<Mask>& masks, double share = 1.0);

}  // namespace pcor::internal
