#pragma once

#include <optional>
#include <string>

#include "improve/model_trials.hpp"

namespace pcor::internal {

/// A model with a surface, and what it does to samples that took no part in its fit.
struct SurfaceOffer {
  std::string effect{};             ///< id of the surface
  double degrees_of_freedom = 0.0;  ///< number of its coefficients that the flights determine
  RefitResult fit{};
  Comparison out_of_fit{};  ///< without and with the surface
  std::string held_out{};   ///< in words: of which samples that is
};

/// Fits a model with a surface of attack and Mach number, and both on held-out flights or parts; where
/// nothing is held out, on five contiguous blocks of the flights, each by fits to the other four. Nothing
/// where the flights do not record the axes.
std::optional<SurfaceOffer> offer_surface(const FlightSet& flights, const TrialModel& model,
                                          const References& references, const RefitOptions& options);

}  // namespace pcor::internal
