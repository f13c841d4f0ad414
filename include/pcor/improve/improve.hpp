#pragma once

#include <pcor/diagnose/diagnose.hpp>
#include <pcor/fit/refit.hpp>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace pcor {

struct ImproveOptions {
  /// Masks, time stamps, loss, held-out flights and training share hold for every refit and every diagnosis.
  RefitOptions refit;
  std::vector<ModelEffect> formulas{};  ///< tried beside the catalogue
  /// Where no effect of the catalogue explains what is left, but a variable of the files does: add a formula
  /// of that variable at the static ports. Not asked for, it is left to the user: what goes with a variable
  /// may have its cause in the laser or a thermometer, and then the corrected pressure would get worse.
  bool trace_variables = false;
  std::size_t most_steps = 8;
  std::function<void(const std::string& what)> progress{};
};

/// A rung of the ladder of errors.
struct ImproveStep {
  std::string added{};                 ///< id of the effect; empty for the model as it was, refitted
  std::string title{};                 ///< of the effect
  std::vector<std::string> aliases{};  ///< effects that the flights could not tell from it
  double rms_train = 0.0;              ///< hPa, on the samples of the fit
  /// On the held-out flights or parts, hPa; without any, on stretches that took no part, five parts in turn.
  double rms_holdout = 0.0;
  double noise_rms = 0.0;  ///< hPa, of the residual of this rung
  std::size_t terms = 0;   ///< free coefficients
  std::string learnt{};    ///< a sentence: what the step taught
  Diagnosis diagnosis{};   ///< of the model at this rung: what is still missing
};

struct Improvement {
  ModelFile model;  ///< the best one, refitted
  std::vector<ImproveStep> steps{};
  std::string why_stopped{};        ///< a sentence
  RefitResult fit;                  ///< of the best model
  bool holdout_is_flights = false;  ///< rms_holdout is of held-out flights or parts, not of parts in turn
  /// Why the best model is worse than the one to begin with, as it was given; empty where it is not.
  std::string worse{};
};

/// Refits the model, learns what is missing, adds it, and begins again, until nothing is missing, what is
/// left cannot be explained, or held-out flights say that another effect does not help.
///
/// @throws Error as `refit` and `diagnose`.
Improvement improve(const std::vector<std::filesystem::path>& flights, const ModelFile& model,
                    const References& references, const ImproveOptions& options = {});

}  // namespace pcor
