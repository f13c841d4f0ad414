#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pcor/fit/refit.hpp>

namespace pcor::internal {

/// A model, and the effects that the systems which it is held against have alike: an angle of the flow at
/// which all pitot tubes lose pressure is no difference between them.
struct TrialModel {
  ModelDefinition file;
  std::vector<std::string> alike{};  ///< names of effects of the model
};

/// The references, those with a model of their own with what is alike as the model has it, for a diagnosis,
/// in which both coefficients are free.
/// @param variables of the flights
References with_alike(const References& references, const TrialModel& model,
                      const std::vector<std::string>& variables);

/// What several models leave on one flight with one reference.
struct TrialFlight {
  std::shared_ptr<const FlightSamples> samples{};
  bool first_reference = true;
  double window = 0.0;                  ///< s, over which a residual holds together, as `Reference::window`
  std::vector<std::size_t> fitted{};    ///< places of the samples that a fit uses
  std::vector<std::size_t> held_out{};  ///< those that it would use were they not held out
  /// Of each model, of all samples, hPa; NaN where a value is missing.
  std::vector<std::vector<double>> residuals{};
  std::vector<std::vector<double>> static_pressures{};  ///< corrected

  template <class Archive>
  void serialize(Archive& archive) {
    archive(samples, first_reference, window, fitted, held_out, residuals, static_pressures);
  }
};

/// Holds models against the same samples: those of the flights, and of the flights that are held out, that a
/// model with the effects of all of them would use. Of an effect the models may only differ in coefficients.
/// @throws Error as `refit`.
std::vector<TrialFlight> try_models(const FlightSet& flights, const std::vector<TrialModel>& models,
                                    const References& references, const RefitOptions& options);

/// Whether a model has an effect of that name.
bool has(const ModelDefinition& model, const std::string& effect);

/// A model that has the effects of all models, with the coefficients of the first that has them.
ModelDefinition union_of(const std::vector<ModelDefinition>& models);

/// The coefficients of a model in the order of those of a union that it is part of: of an effect that it does
/// not have those with which the effect does nothing, in the shape that it has in the union.
std::vector<double> coefficients_in(const ModelDefinition& model, const ModelDefinition& whole);

/// What two models leave on the same samples.
struct Comparison {
  double rms_before = 0.0;  ///< with the first reference, hPa; NaN where there are no samples
  double rms_after = 0.0;
  /// Fall of the squared residuals with all references, in units of the noise, and its error from how it
  /// differs between minutes.
  double gain = 0.0;
  double gain_error = 0.0;
  double first_gain = 0.0;  ///< with the first reference alone
  double first_gain_error = 0.0;

  /// By more than chance, with all references, or with the first one while all together do not surely object:
  /// what systems have alike is hardly seen where they are compared with each other.
  bool is_better() const;
  bool is_worse() const;  ///< by more than chance, with all references
};

/// Model number `after` beside model number `before`, on samples that were held out or that were fitted.
Comparison comparison_of(const std::vector<TrialFlight>& flights, std::size_t before, std::size_t after,
                         bool held_out);

/// The corrected static pressures of a model at the samples of the fit, hPa, flight after flight.
std::vector<double> static_pressures_of(const std::vector<TrialFlight>& flights, std::size_t model);

}  // namespace pcor::internal
