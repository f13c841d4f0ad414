#pragma once

#include <optional>
#include <string>

#include "improve/model_trials.hpp"

namespace pcor::internal {

/// A model with the first of `surface_info`, and its residuals on samples outside its fit.
struct SurfaceOffer {
  double degrees_of_freedom = 0.0;  ///< number of its coefficients that the flights determine
  RefitResult fit{};
  TrialComparison out_of_fit{};  ///< comparison without and with the surface
  std::string held_out{};        ///< description of these samples
};

/// Fits a model with a surface of attack and Mach number, and compares it with the model without it on
/// held-out flights or parts; if nothing is held out, on five contiguous blocks of the flights, each with
/// fits to the other four. Empty if the flights do not record the axes.
std::optional<SurfaceOffer> offer_surface(const FlightSet& flights, const TrialModel& model,
                                          const References& references, const RefitOptions& options);

}  // namespace pcor::internal
