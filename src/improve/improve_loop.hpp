#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <pcor/improve/improve.hpp>
#include "improve/model_trials.hpp"
#include "improve/offered_effect.hpp"
#include "improve/surface_offer.hpp"

namespace pcor::internal {

/// Dependencies of the `improve` loop, replaceable for tests without flights.
struct ImproveLoop {
  std::function<RefitResult(const TrialModel& model)> refit;
  std::function<Diagnosis(const TrialModel& model)> diagnose;
  std::function<TrialModel(const TrialModel& model, const AddedEffect& added)> add;
  std::function<std::vector<TrialFlight>(const std::vector<TrialModel>& models)> try_models;
  /// May be empty: then no surface is offered.
  std::function<std::optional<SurfaceOffer>(const TrialModel& model)> offer_surface;
  bool has_holdout = false;     ///< the refit reports on held-out samples
  bool is_by_gps = false;       ///< the first reference is wind or height
  bool trace_variables = true;  ///< see `ImproveOptions`
  std::size_t max_steps = 8;    ///< maximum number of added effects
  std::string flights{};        ///< description for the source of the formula of a predictor

  /// Selects effects step by step, from `model`. @throws Error as `refit` and `diagnose` do for the initial
  /// model.
  Improvement run(const ModelDefinition& model) const;
};

}  // namespace pcor::internal
