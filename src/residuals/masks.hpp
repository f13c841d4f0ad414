#pragma once

#include <vector>

#include "residuals/reference_on_samples.hpp"

namespace pcor::internal {

/// The masks by how a flight was flown and what the user excluded, whatever the model: `excluded`, `ground`,
/// `low_speed`, `flaps`, `regime`, or none.
std::vector<Mask> masks_as_flown(const FlightSamples& samples, const MaskOptions& options);

/// All masks. @param residual of every sample, with the parameters of the files
std::vector<Mask> find_masks(const FlightSamples& samples, const ReferenceOnSamples& reference,
                             const std::vector<double>& residual, const MaskOptions& options);

}  // namespace pcor::internal
