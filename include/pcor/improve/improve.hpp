#pragma once

#include <pcor/diagnose/diagnose.hpp>
#include <pcor/diagnose/what_if.hpp>
#include <pcor/fit/refit.hpp>

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace pcor {

struct ImproveOptions {
  /// Masks, loss, held-out flights and training share, used for every refit and every diagnosis.
  RefitOptions refit;
  std::vector<ModelEffect> formulas{};  ///< formula effects tested in addition to the catalogue
  /// Adds a formula of a recorded variable if no effect of the catalogue explains the residual but the
  /// variable does; it acts at the static ports unless the total pressures show the same structure. Off by
  /// default: the cause may lie in the laser or a thermometer, and the corrected pressure would then get
  /// worse.
  bool trace_variables = false;
  std::size_t max_steps = 8;
  std::function<void(const std::string& what)> progress{};
};

/// Reason for the end of the selection.
enum class StopReason {
  nothing_missing,   ///< no missing effect is detectable
  reference_system,  ///< the finding may be an error of the reference system
  in_model,          ///< the findings are already in the model
  unexplained,       ///< no effect of the catalogue explains the remaining structure
  /// The tried effects cannot be fitted, do not reduce the residual of held-out samples, or, by GPS alone,
  /// are not significant or have an impossible size.
  no_gain,
  max_steps  ///< `ImproveOptions::max_steps` effects were added
};

/// Text: "nothing missing", "reference system", "in model", "unexplained", "no gain", "max steps".
std::string_view to_string(StopReason reason);

/// Alternative to the added effect of a selection step.
struct StepRival {
  std::string effect{};
  double probability = 0.0;    ///< posterior probability among the alternatives of the step
  double static_change = 0.0;  ///< change of the corrected static pressure by this effect alone, rms hPa
};

template <class Field>
void describe(const StepRival& self, Field& field) {
  field("effect", self.effect, "id of the effect");
  field("probability", self.probability, "posterior probability among the alternatives");
  field("static_change_hpa", self.static_change, "change of the corrected static pressure, rms");
}

/// Step of the forward selection.
struct ImproveStep {
  std::string added{};                 ///< id of the effect; empty for the refitted input model
  std::string title{};                 ///< title of the effect
  std::vector<std::string> aliases{};  ///< effects not separable from it on these flights
  double rms_train = 0.0;              ///< hPa, on the training samples
  /// On the held-out flights or parts, hPa; cross-validated (five folds) if there are no held-out data. A
  /// surface is tested on five other blocks: its value is that of the step before times the ratio on these
  /// blocks.
  double rms_holdout = 0.0;
  double noise_rms = 0.0;  ///< noise of the residual in this step, hPa
  std::size_t terms = 0;   ///< free coefficients
  std::string summary{};   ///< summary of the step, one sentence
  Diagnosis diagnosis{};   ///< diagnosis of the model in this step
  /// Alternatives with different corrected static pressures; the added effect is the first. Empty if the
  /// choice does not matter.
  std::vector<StepRival> rivals{};
  /// Id of the effect in the written model: the added one, an alternative, or empty.
  std::string delivered{};
  double rival_error = 0.0;  ///< expected error of that choice, rms hPa; included in the stated error
};

template <class Field>
void describe(const ImproveStep& self, Field& field) {
  field("added", self.added.empty() ? nullptr : &self.added, "id of the added effect; null first");
  field("title", self.title, "title of the effect");
  field("aliases", self.aliases, "effects that these flights do not separate from it");
  field("rms_train_hpa", self.rms_train, "rms residual on the training samples");
  field("rms_holdout_hpa", self.rms_holdout, "rms residual on held-out samples, otherwise cross-validated");
  field("noise_rms_hpa", self.noise_rms, "rms noise of the residual");
  field("terms", self.terms, "number of free coefficients");
  field("learnt", self.summary, "summary of the step");
  field("delivered", self.delivered, "id of the effect in the written model; may be empty");
  field("rival_error_hpa", self.rival_error, "expected error of that choice, rms");
  field("rivals", self.rivals, "alternatives with different corrected static pressures");
  field("diagnosis", self.diagnosis, "diagnosis of the model in this step");
}

/// Residuals of a flight with the first reference, all samples, hPa; NaN for samples not used.
struct ImprovedFlight {
  std::shared_ptr<const FlightSamples> samples{};  ///< never null
  std::size_t fitted = 0;                          ///< samples in the fit
  std::size_t held_out = 0;                        ///< held-out samples: the whole flight or its last part
  std::vector<double> given{};                     ///< residual of the input model
  std::vector<double> refitted{};
  std::vector<double> best{};  ///< residual of the final model
};

struct Improvement {
  ModelDefinition model;     ///< final model, refitted, with the applied alternatives
  ModelDefinition refitted;  ///< input model, refitted
  /// Rms residual of the input model, hPa, on the training samples.
  double given_rms_train = std::numeric_limits<double>::quiet_NaN();
  /// Rms residual on held-out flights or parts; NaN without held-out samples.
  double given_rms_holdout = std::numeric_limits<double>::quiet_NaN();
  /// Rms residual of the final model, hPa.
  double rms_train = std::numeric_limits<double>::quiet_NaN();
  double rms_holdout = std::numeric_limits<double>::quiet_NaN();
  std::vector<ImproveStep> steps{};
  StopReason stop_reason = StopReason::nothing_missing;
  std::string stop_explanation{};  ///< the reason with its numbers, one sentence
  RefitResult fit;  ///< fit of the model with the added effects, before the choice of alternatives
  std::vector<ImprovedFlight> flights{};
  /// True: rms_holdout is from held-out flights or parts; false: from cross-validation.
  bool holdout_is_flights = false;
  std::string output{};  ///< file of the final model, filled by the caller
  /// Reason for which the best model is worse than the input model; empty if it is better.
  std::string rejection_reason{};
};

/// Finding that was added in a step, from the diagnosis before it; null if the step added no finding under
/// its own name. @param step index, at least 1
const Finding* finding_of(const Improvement& improvement, std::size_t step);

template <class Field>
void describe(const Improvement& self, Field& field) {
  const auto rms = [&field](const char* key, double train, double holdout, const char* meaning) {
    field.object(key, meaning, [=](Field& of_model) {
      of_model("rms_train_hpa", train, "rms residual on the training samples");
      of_model("rms_holdout_hpa", holdout, "rms residual on held-out samples");
    });
  };
  field("steps", self.steps, "steps of the selection");
  rms("as_it_came", self.given_rms_train, self.given_rms_holdout, "input model");
  rms("delivered", self.rms_train, self.rms_holdout, "written model");
  field("unexplained", self.steps.empty() ? Unexplained() : self.steps.back().diagnosis.unexplained,
        "unexplained structure at the end");
  field(
      "stop_reason", self.stop_reason,
      "end of the selection: nothing missing, reference system, in model, unexplained, no gain or max steps");
  field("why_stopped", self.stop_explanation, "reason for the end of the selection, with its numbers");
  field("holdout_is_flights", self.holdout_is_flights, "false: rms_holdout_hpa is cross-validated");
  field("worse", self.rejection_reason,
        "reason for which the result is worse than the input model; otherwise empty");
  field("flaps_out", self.fit.flaps_out, "residual of samples excluded because of flaps");
  field("notes", self.fit.notes, "notes on the fit");
  describe_summary(self.fit, field);
  field("model", self.output, "file of the written model");
}

/// Text on the alternatives of a step between which the choice matters; empty without such alternatives.
std::string rivals_text(const ImproveStep& step);

/// Refits the model, diagnoses it, adds the missing effect and iterates until no effect is missing, the
/// remaining structure is unexplained, or held-out flights show no gain from another effect. If flights do
/// not separate several effects and the choice matters for the static pressure, the model gets the one with
/// the least expected error, or no such effect if each candidate would increase the error under another one.
///
/// @throws Error as `refit` and `diagnose`.
Improvement improve(const FlightSet& flights, const ModelDefinition& model, const References& references,
                    const ImproveOptions& options = {});

/// Effects of the selection steps and their alternatives, for interactive addition to the refitted input
/// model. Arguments as in `improve`. @throws Error as `diagnose`.
WhatIf what_if(const FlightSet& flights, const Improvement& improvement, const References& references,
               const ImproveOptions& options);

}  // namespace pcor
