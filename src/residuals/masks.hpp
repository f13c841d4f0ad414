#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

class ModelOnSamples;
class ReferenceOnSamples;

/// The masks by how a flight was flown and what the user excluded, whatever the model: `excluded`, `ground`,
/// `low_speed`, `flaps`, `regime`, or none.
std::vector<Mask> masks_as_flown(const FlightSamples& samples, const MaskOptions& options);

/// What takes part where a model is held against a reference.
struct MaskedResidual {
  const FlightSamples& samples;
  const ModelOnSamples& model;
  const ReferenceOnSamples& reference;
  const std::vector<double>& values;  ///< of every sample, with the parameters of the files
};

/// All masks.
std::vector<Mask> find_masks(const MaskedResidual& residual, const MaskOptions& options);

/// Whether an effect describes what flaps do. @param variable of the flight's flaps, which a formula may name
bool reads_flaps(const ModelEffect& effect, const std::string& variable);

/// The samples that take part: the first `share` of them, rounded.
std::vector<std::size_t> used_samples(const std::vector<Mask>& masks, double share = 1.0);

}  // namespace pcor::internal
