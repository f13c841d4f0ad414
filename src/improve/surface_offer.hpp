#pragma once

#include <optional>
#include <string>

#include "improve/model_trials.hpp"

namespace pcor::internal {

/// A model with the first of `surface_info`, not yet fitted to all samples, and its residuals.
struct SurfaceOffer {
  TrialModel model{};
  TrialComparison compared{};  ///< comparison without and with the surface
  std::string compared_on{};   ///< description of the samples
  double static_change = 0.0;  ///< change of the corrected static pressure by the surface, rms hPa
  /// True if all references are other static systems that are not trusted: the surface may be of either one.
  bool may_be_of_reference = false;
};

/// Compares a model with and without a surface of attack and Mach number on held-out flights or parts; if
/// nothing is held out, on five contiguous blocks of the flights, each with fits to the other four, or, if
/// the rms of the fitted samples decreases too little, on these. Empty if the flights do not record the axes.
/// @param model with fitted coefficients
std::optional<SurfaceOffer> offer_surface(const FlightSet& flights, const TrialModel& model,
                                          const References& references, const RefitOptions& options);

}  // namespace pcor::internal
