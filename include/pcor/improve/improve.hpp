#pragma once

#include <pcor/diagnose/diagnose.hpp>
#include <pcor/diagnose/what_if.hpp>
#include <pcor/fit/refit.hpp>

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace pcor {

struct ImproveOptions {
  /// Masks, loss, held-out flights and training share hold for every refit and every diagnosis.
  RefitOptions refit;
  std::vector<ModelEffect> formulas{};  ///< tried beside the catalogue
  /// Where no effect of the catalogue explains what is left, but a variable of the files does: add a
  /// formula of that variable, at the static ports unless the total pressures have it too. Not asked for, it
  /// is left to the user: what goes with a variable may have its cause in the laser or a thermometer, and
  /// then the corrected pressure would get worse.
  bool trace_variables = false;
  std::size_t max_steps = 8;
  std::function<void(const std::string& what)> progress{};
};

/// What the added effect of a rung may be.
struct RungRival {
  std::string effect{};
  double probability = 0.0;    ///< among the rivals of the rung
  double static_change = 0.0;  ///< by how much it alone changes the corrected static pressure, rms hPa
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
  /// Where it matters for the static pressure which of them is there. The added effect is the first.
  std::vector<RungRival> rivals{};
  std::string delivered{};   ///< id of the effect that the written model has: the added one, a rival, or none
  double rival_error = 0.0;  ///< expected error of that choice, rms hPa; part of the stated error
};

/// The residuals of a flight with the first reference, of all samples, hPa; NaN where they do not count.
struct ImprovedFlight {
  std::shared_ptr<const FlightSamples> samples{};
  std::size_t fitted = 0;       ///< samples in the fit
  std::size_t held_out = 0;     ///< samples that were held out, of the whole flight or its last part
  std::vector<double> given{};  ///< with the model as it came
  std::vector<double> refitted{};
  std::vector<double> best{};  ///< with the model that is delivered
};

struct Improvement {
  ModelDefinition model;     ///< the best one, refitted, with the rivals that are applied
  ModelDefinition refitted;  ///< the one that came, refitted
  double given_rms_train =
      std::numeric_limits<double>::quiet_NaN();  ///< of the model as it came, hPa, on the samples of the fit
  double given_rms_holdout = std::numeric_limits<double>::quiet_NaN();  ///< on what was held out; NaN without
                                                                        ///< held-out flights or parts
  double rms_train = std::numeric_limits<double>::quiet_NaN();          ///< of the model that is delivered
  double rms_holdout = std::numeric_limits<double>::quiet_NaN();
  std::vector<ImproveStep> steps{};
  std::string why_stopped{};  ///< a sentence
  RefitResult fit;            ///< of the best model, before rivals were weighed
  std::vector<ImprovedFlight> flights{};
  bool holdout_is_flights = false;  ///< rms_holdout is of held-out flights or parts, not of parts in turn
  /// Why the best model is worse than the one to begin with, as it was given; empty where it is not.
  std::string worse{};
};

/// What a rung says of rivals that it matters to choose between; empty where there are none.
std::string rivals_text(const ImproveStep& step);

/// Refits the model, learns what is missing, adds it, and begins again, until nothing is missing, what is
/// left cannot be explained, or held-out flights say that another effect does not help. EffectLocation
/// flights cannot tell several effects apart and it matters for the static pressure which of them is there,
/// the model has the one of the least expected error, or none where one of them would call each other one a
/// harm.
///
/// @throws Error as `refit` and `diagnose`.
Improvement improve(const FlightSet& flights, const ModelDefinition& model, const References& references,
                    const ImproveOptions& options = {});

/// The effects of the ladder, and what they could not be told from, for a reader to add under his hand to the
/// model that came, refitted. Arguments as of `improve`. @throws Error as `diagnose`.
WhatIf what_if(const FlightSet& flights, const Improvement& improvement, const References& references,
               const ImproveOptions& options);

}  // namespace pcor
