#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <pcor/improve/improve.hpp>
#include "improve/model_trials.hpp"
#include "improve/surface_offer.hpp"

namespace pcor::internal {

/// Effect to add to a model.
struct AddedEffect {
  ModelEffect effect;               ///< the model with the starting coefficients
  std::vector<std::string> held{};  ///< parameters that the flights do not determine
  bool is_alike = false;            ///< the reference systems have the same effect
  double probability = 1.0;         ///< posterior probability among the effect and its rivals
};

/// Correction to deliver if one of several rivals is the cause.
struct RivalChoice {
  std::optional<std::size_t> rival{};  ///< index; empty if no rival is applied
  double error = 0.0;                  ///< expected, rms over samples and rivals, hPa
  double error_of_first = 0.0;         ///< the same if the first rival is applied
};

/// Chooses the rival of the least expected squared error of the static pressure,
///   sum over k of weight_k <(change_i - change_k)^2>,
/// among those that are harmful under no rival: under any rival, the corrected static pressure may be worse
/// than the uncorrected one by at most `tolerance`. No correction is also a choice. Where the expected error
/// of the first rival is within the tolerance, it stays. Coefficients of different models are never averaged:
/// a coefficient of one effect may multiply that of another.
///
/// @param changes change of the static pressure by each rival, hPa, on the same samples, NaN if missing
/// @param weights probabilities of the rivals, which add up to 1 @param tolerance rms, hPa
RivalChoice choose_rival(const std::vector<std::vector<double>>& changes, const std::vector<double>& weights,
                         double tolerance);

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
  std::string flights{};        ///< description for the source of a traced formula

  /// Selects effects step by step, from `model`. @throws Error as `refit` and `diagnose` do for the initial
  /// model.
  Improvement run(const ModelDefinition& model) const;
};

}  // namespace pcor::internal
