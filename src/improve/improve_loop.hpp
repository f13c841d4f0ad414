#pragma once

#include <functional>

#include <pcor/improve/improve.hpp>
#include "improve/model_trials.hpp"
#include "improve/surface_offer.hpp"

namespace pcor::internal {

/// An effect that is to be added to a model.
struct AddedEffect {
  ModelEffect effect;               ///< with the coefficients to start from
  std::vector<std::string> held{};  ///< parameters that the flights do not tell
  bool is_alike = false;            ///< the systems that the model is held against have it too
};

/// What the loop of `improve` is made of, so that it can be tried without flights.
struct ImproveLoop {
  std::function<RefitResult(const TrialModel& model)> refit;
  std::function<Diagnosis(const TrialModel& model)> diagnose;
  std::function<TrialModel(const TrialModel& model, const AddedEffect& added)> add;
  std::function<std::vector<TrialFlight>(const std::vector<TrialModel>& models)> try_models;
  /// May be empty: then no surface is offered.
  std::function<std::optional<SurfaceOffer>(const TrialModel& model)> offer_surface;
  bool has_holdout = false;     ///< the refit tells of samples that are held out
  bool trace_variables = true;  ///< as in `ImproveOptions`
  std::size_t max_steps = 8;    ///< effects that are added at most
  std::string flights{};        ///< in words, for the source of a traced formula

  /// Climbs the ladder of errors from `model`. @throws Error as `refit` and `diagnose` for the model as it
  /// is.
  Improvement run(const ModelDefinition& model) const;
};

}  // namespace pcor::internal
