#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pcor/fit/refit.hpp>

namespace pcor::internal {

/// Model, and the effects that the reference systems share with it: a flow angle at which all pitot tubes
/// lose pressure causes no difference between them.
struct TrialModel {
  ModelDefinition file;
  std::vector<std::string> shared_effects{};  ///< ids of these effects
};

/// References for a diagnosis; those with their own model get the shared effects of the model, with both
/// coefficients free.
/// @param variables variables of the flights
References references_with_shared_effects(const References& references, const TrialModel& model,
                                          const std::vector<std::string>& variables);

/// Residuals of several models on one flight with one reference.
struct TrialFlight {
  std::shared_ptr<const FlightSamples> samples{};
  bool first_reference = true;
  double window = 0.0;                  ///< s, as `Reference::window`
  std::vector<std::size_t> fitted{};    ///< indices of the samples that a fit uses
  std::vector<std::size_t> held_out{};  ///< indices of samples excluded only because they are held out
  /// Residuals of each model for all samples, hPa; NaN if a value is missing.
  std::vector<std::vector<double>> residuals{};
  std::vector<std::vector<double>> static_pressures{};  ///< corrected, hPa

  template <class Archive>
  void serialize(Archive& archive) {
    archive(samples, first_reference, window, fitted, held_out, residuals, static_pressures);
  }
};

/// Compares models on the same samples of the fitted and held-out flights: the samples that a model with the
/// effects of all of them would use. Common effects may differ only in their coefficients.
/// @throws Error as `refit`.
std::vector<TrialFlight> try_models(const FlightSet& flights, const std::vector<TrialModel>& models,
                                    const References& references, const RefitOptions& options);

/// Model that has the effects of all models, with the coefficients of the first that has them.
ModelDefinition union_of(const std::vector<TrialModel>& models);

/// The model `extended` with coefficients and errors of the input model. Other effects get neutral
/// coefficients, formulas keep theirs. By GPS alone the prior of a fit is about its start, which is then no
/// earlier estimate.
ModelDefinition with_start_of(const ModelDefinition& given, ModelDefinition extended);

/// Coefficients of a model in the order of a union that contains it: absent effects get neutral coefficients,
/// in their shape in the union.
std::vector<double> coefficients_in(const ModelDefinition& model, const ModelDefinition& whole);

/// Standard errors of a gain that a paired test requires: 95 %, one-sided, as a gain is better or is not.
inline constexpr double sure_gain = 1.645;

/// Maximum ratio of the held-out rms with an effect to that without it, if it is not known to be the cause.
inline constexpr double unnamed_limit = 0.99;

/// Residuals of two models on the same samples.
struct TrialComparison {
  double rms_before = 0.0;  ///< first reference, hPa; NaN if there are no samples
  double rms_after = 0.0;
  /// Decrease of the squared residuals with all references, in units of the noise, and its error from the
  /// scatter between minutes.
  double chi2_reduction = 0.0;
  double chi2_reduction_error = 0.0;
  double first_chi2_reduction = 0.0;  ///< first reference alone
  double first_chi2_reduction_error = 0.0;

  /// Significant with all references, or with the first one unless all together significantly disagree:
  /// shared effects are hardly visible in comparisons between systems.
  bool is_better() const;
  bool is_worse() const;  ///< significant with all references
};

/// Comparison of model `after` with model `before` on held-out or fitted samples.
TrialComparison comparison_of(const std::vector<TrialFlight>& flights, std::size_t before, std::size_t after,
                              bool held_out);

/// Changes of the corrected static pressure from model `before` to model `after` at the samples of the fit,
/// hPa, in the order of the flights.
std::vector<double> static_changes_of(const std::vector<TrialFlight>& flights, std::size_t before,
                                      std::size_t after);

}  // namespace pcor::internal
