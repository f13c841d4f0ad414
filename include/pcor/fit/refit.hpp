#pragma once

#include <pcor/base/note.hpp>
#include <pcor/campaign/flight_set.hpp>
#include <pcor/fit/loss.hpp>
#include <pcor/residuals/residuals.hpp>
#include <pcor/residuals/statistics.hpp>

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcor {

/// Stage of a fit: some parameters, fitted only to samples of some regimes, with one free offset of delta-p/p
/// per interval, as the memo determined the sensitivities of its eq. 19 from manoeuvres. Stages are iterated
/// until every coefficient changes by less than a hundredth of its standard error.
struct FitStage {
  std::vector<Regime> regimes;
  /// Parameters such as "static-alpha.a1", or effects (all their parameters).
  std::vector<std::string> parameters;
};

struct RefitOptions {
  MaskOptions mask;
  Loss loss = Loss::huber;
  std::vector<std::string> fix{};   ///< parameters or effects, fixed in addition to those that the file fixes
  std::vector<std::string> free{};  ///< parameters or effects, fitted although the file fixes them
  std::vector<FitStage> stages{};
  /// The model of the reference, if it is a static system, is fitted together with the model.
  bool fit_reference = false;
  /// Effects of the model that are common to the systems of the references: they cancel in the difference of
  /// two systems and are excluded there. Otherwise a lag, for example, would be estimated from the noise of
  /// both sensors.
  std::vector<std::string> shared_effects{};
  /// Gaussian prior at the starting value of every coefficient: covariance from the model file, otherwise the
  /// typical size of the effect, for a formula the value itself. Always used if the reference is fitted too:
  /// two static systems determine only their difference, and common effects keep the value and error of the
  /// prior.
  bool use_prior = false;
  /// Effects that a diagnosis added to the model, with its estimates as starting values. Each coefficient has
  /// a Gaussian prior about its neutral value; the standard deviation is three times the typical size of the
  /// effect, or the estimate if that is larger. A coefficient that the flights do not determine stays small,
  /// and one that they determine does not change. Without influence if `use_prior` is true, and on a fit to
  /// GPS alone, which has a prior.
  std::vector<std::string> added{};
  /// The calibration of the references and of the thermometer is exact. Otherwise its error is part of the
  /// standard errors: `ParameterInfo::calibration_uncertainty`, or `[uncertainty]` of the model. Stated
  /// errors of the law of a second system are always included.
  bool trust_reference = false;
  /// Fraction of each flight used, from its start, 0 to 1; the rest is held out.
  double training_share = 1.0;
  FlightSet holdout{};  ///< flights excluded from the fit
  /// Flights reduced in parallel; 0: number of processors, or one if there are several ranks.
  std::size_t threads = 0;
  std::function<void(std::size_t pass, std::size_t passes)> progress{};
};

/// Fitted coefficient.
struct FittedParameter {
  std::string name;  ///< name such as "static-qp.a2"; for the reference's model "reference:static-qp.a2"
  std::string unit;
  double start = 0.0;
  double value = 0.0;
  /// Includes autocorrelation and drift of the noise, the misfit of the model, and the uncertainties of fixed
  /// coefficients and of the reference's calibration; NaN if it was not fitted or is at a bound.
  double standard_error = 0.0;
  /// Standard error without the misfit of the model and the uncertainty of the calibration.
  double noise_error = 0.0;
  /// Jackknife standard error over flights, or parts of a flight; independent of the noise model. Infinite if
  /// one of these alone determines the coefficient; NaN with fewer than three of these.
  double jackknife_error = 0.0;
  bool fitted = false;
  bool at_bound = false;
  int stage = 0;  ///< stage of the fit, from 1; the last one fits all remaining parameters
};

/// Coefficients of one effect in JSON, with names such as "a2".
struct FittedEffect {
  std::string id;
  std::vector<FittedParameter> parameters{};
};

/// Coefficients grouped by their effects, in order.
std::vector<FittedEffect> fitted_effects(const std::vector<FittedParameter>& parameters);

template <class Field>
void describe(const FittedEffect& self, Field& field) {
  const auto names = [&self](auto condition) {
    std::vector<std::string> those;
    for (const FittedParameter& each : self.parameters) {
      if (condition(each)) those.push_back(each.name);
    }
    return those.empty() ? std::nullopt : std::optional(those);
  };
  const char* const unit = "unit of the coefficient";
  using Parameter = FittedParameter;
  field("id", self.id, "id of the effect");
  field("parameters", field.named(self.parameters, &Parameter::value), "fitted coefficients", unit);
  field("stderr", field.named(self.parameters, &Parameter::standard_error), "standard errors", unit);
  field("stderr_noise", field.named(self.parameters, &Parameter::noise_error),
        "standard errors without misfit and calibration", unit);
  field("stderr_jackknife", field.named(self.parameters, &Parameter::jackknife_error),
        "standard errors by jackknife over flights or their parts; null if one alone determines the "
        "coefficient",
        unit);
  field("start", field.named(self.parameters, &Parameter::start), "coefficients before the fit", unit);
  field("at_bound", names([](const Parameter& each) { return each.at_bound; }),
        "coefficients at a bound; absent if none");
  field("fixed", names([](const Parameter& each) { return !each.fitted; }),
        "coefficients that were not fitted; absent if none");
}

/// Fit statistics with one effect removed and the others refitted.
struct Omission {
  std::string effect;
  double rms = 0.0;  ///< hPa
  double r_squared = 0.0;
};

template <class Field>
void describe(const Omission& self, Field& field) {
  field("effect", self.effect, "id of the removed effect");
  field("rms_hpa", self.rms, "rms residual without it");
  field("r2", self.r_squared, "R2 without it");
}

/// Result of the fit for one surface, in addition to its coefficients.
struct SurfaceFit {
  std::string effect;
  double roughness = 0.0;  ///< standard deviation of a second difference of Cp, by marginal likelihood
  double degrees_of_freedom = 0.0;  ///< number of coefficients that the flights determine
};

template <class Field>
void describe(const SurfaceFit& self, Field& field) {
  field("effect", self.effect, "id of the surface");
  field("roughness", self.roughness, "standard deviation of a second difference of Cp");
  field("degrees_of_freedom", self.degrees_of_freedom, "number of coefficients that the flights determine");
}

/// Flight statistics before and after the fit.
struct FlightFit {
  std::string flight;
  bool holdout = false;
  Statistics before;
  Statistics after;
  double expected_bias = 0.0;  ///< `HeldOutPart::expected` of a part that was held out, hPa
  std::string reference{};     ///< see `Reference::name`
};

template <class Field>
void describe(const FlightFit& self, Field& field) {
  field("name", self.flight, "file of the flight");
  field("reference", self.reference, "reference");
  field("holdout", self.holdout, "whether the samples are held out");
  field("before", self.before, "residual before the fit");
  field("after", self.after, "residual after the fit");
}

/// Held-out part with the largest ratio of bias to expected bias.
std::optional<HeldOutPart> worst_held_out(const std::vector<FlightFit>& flights);

/// Estimators of coefficients and errors, one sentence each.
inline constexpr std::string_view refit_estimator =
    "Coefficients by least squares with Huber's loss, four robust deviations wide; errors from the noise "
    "with its "
    "drift and from the misfit of the law.";
inline constexpr std::string_view refit_estimator_of_gps =
    "Coefficients by maximum likelihood, with winds, D-value and errors of GPS and instruments as random "
    "processes; errors from that likelihood or from the scatter of blocks of five minutes: the larger one "
    "for each combination of coefficients.";

struct RefitResult {
  ModelDefinition model;  ///< fitted model with coefficients, standard errors, covariance and provenance
  std::optional<ModelDefinition> reference{};  ///< fitted model of the reference, if it was fitted too
  std::vector<FittedParameter> parameters{};
  std::vector<std::string> covariance_names{};
  /// Covariance of the fitted parameters and of fixed parameters with a stated error, followed by the
  /// calibration of the thermometer, such as "temp-offset.offset", if it is uncertain.
  std::vector<std::vector<double>> covariance{};
  std::size_t samples = 0;
  double rms = 0.0;                ///< hPa, all samples in the fit including outliers
  double rms_over_pressure = 0.0;  ///< rms of residual / static pressure
  double bulk_rms = 0.0;           ///< robust standard deviation, hPa; insensitive to outliers
  double noise_rms = 0.0;          ///< noise floor, hPa
  double drift_rms = 0.0;          ///< drift of the sensors, hPa
  /// Rms misfit of the model as a smooth function of the flight state, hPa.
  double misfit_rms = 0.0;
  /// Standard deviation between flights of the mean residual, hPa; 0 with one flight, NaN by GPS alone. The
  /// fitted model states the root of the sum of squares of both as the standard uncertainty of its delta-p in
  /// one sample.
  double between_flights = 0.0;
  double least_squares_rms = 0.0;  ///< plain least squares on the same samples, hPa; NaN if unknown
  double r_squared = 0.0;
  /// hPa, with the input model; NaN if samples have no residual with them.
  double rms_before = 0.0;
  std::size_t outliers = 0;  ///< samples that differ from their prediction by more than the noise permits
  /// Ratio of the largest to the smallest singular value of the derivatives, each column normalised.
  double condition_number = 0.0;
  double autocorrelation_time = 1.0;
  std::array<std::size_t, mask_count> masks{};
  std::size_t jackknife_parts = 0;  ///< number of flights, or parts of flights, left out in the jackknife
  std::vector<Omission> omissions{};
  std::vector<SurfaceFit> surfaces{};
  std::vector<FlightFit> flights{};
  std::vector<FlightFit> further{};  ///< fit statistics with each further reference, by flight
  Statistics flaps_out;  ///< residuals, with the fitted coefficients, of samples excluded because of flaps
  /// Standard error of delta-p due to all fitted coefficients, hPa, rms over the flights; zero without the
  /// references wind and height.
  double defect_error = 0.0;
  std::string reference_text{};
  std::string_view estimator = refit_estimator;
  /// True for a fit by wind and height alone. Then `FittedParameter::noise_error` is that of the likelihood,
  /// and the stated errors are by the likelihood or by the jackknife: the larger one for each
  /// combination of coefficients.
  bool is_by_gps() const { return estimator == refit_estimator_of_gps; }
  /// Label of `noise_rms`: by GPS an upper limit, as in `ModelComparison::is_by_gps`.
  const char* noise_label() const { return is_by_gps() ? "max noise" : "noise"; }
  /// Reason for which the model should not be used: the fit is worse than the input model, or a
  /// held-out part has a significant bias. Otherwise empty.
  std::string rejection_reason{};
  std::vector<std::string> warnings{};  ///< reasons to doubt the fit, one sentence each
  Notes notes{};                        ///< notes for the user, one sentence each, by decreasing severity
};

/// Keys that `refit` and `improve` share.
template <class Field>
void describe_summary(const RefitResult& self, Field& field) {
  field("estimator", self.estimator, "estimator of the coefficients and their errors");
  field("left_hpa", self.misfit_rms,
        "misfit of the model that varies with the flight state, rms; null for a fit by GPS alone");
  field("between_flights_hpa", self.between_flights,
        "standard deviation between flights of the mean residual; null for a fit by GPS alone");
  field("drift_hpa", self.drift_rms, "slow drift of the noise, rms");
  field("least_squares_rms_hpa", self.least_squares_rms,
        "rms residual of plain least squares; null for a fit with GPS");
  const std::optional<HeldOutPart> worst = worst_held_out(self.flights);
  if (!field.has(worst.has_value())) return;
  field.object("holdout", "held-out part with the most significant bias; absent if none",
               [&worst](Field& holdout) {
                 const HeldOutPart part = worst.value_or(HeldOutPart());
                 holdout("name", part.flight, "file of the flight");
                 holdout("rms_hpa", part.statistics.rms, "rms residual");
                 holdout("bias_hpa", part.statistics.bias, "mean residual");
                 holdout("expected_hpa", part.expected, "expected standard deviation of the bias");
                 holdout("is_off", part.is_off(), "whether the bias is significant");
               });
}

template <class Field>
void describe(const RefitResult& self, Field& field) {
  field("effects", fitted_effects(self.parameters), "effects with their coefficients");
  field("rms_hpa", self.rms, "rms residual after the fit, all samples");
  field("rms_before_hpa", self.rms_before, "rms residual before the fit; null if samples have no residual");
  field("rms_over_pressure", self.rms_over_pressure, "rms of residual divided by static pressure");
  field("bulk_rms_hpa", self.bulk_rms, "robust standard deviation of the residual");
  field("noise_rms_hpa", self.noise_rms, "rms noise of the residual");
  field("drift_rms_hpa", self.drift_rms, "slow drift of the noise, rms");
  describe_summary(self, field);
  if (field.has(self.defect_error > 0.0))
    field("delta_p_stderr_hpa", self.defect_error, "standard error of delta-p; with GPS only");
  field("r2", self.r_squared, "fraction of the variance of delta-p of the reference that the model explains");
  field("samples", self.samples, "number of samples in the fit");
  field("outliers", self.outliers, "number of outliers among them");
  field("samples_per_independent", self.autocorrelation_time, "autocorrelation time", "samples");
  field("condition_number", self.condition_number, "condition number of the derivatives");
  field("reference", self.reference_text, "description of the references");
  field("surfaces", self.surfaces, "fitted surfaces");
  field.object("covariance", "covariance of the coefficients", [&self](Field& covariance) {
    covariance("parameters", self.covariance_names, "names of the coefficients");
    covariance("matrix", self.covariance, "covariance matrix, row by row", "product of the units");
  });
  field("omissions", self.omissions, "fit without each effect");
  field("flights", self.flights, "residual of each flight with the first reference");
  field("further", self.further, "residual of each flight with further references");
  field("masks", field.named(mask_info, self.masks), "samples with each mask");
  if (field.has(!self.rejection_reason.empty()))
    field("worse", self.rejection_reason, "reason for which the model should not be used; otherwise absent");
  field("warnings", self.warnings, "reasons to doubt the fit");
  field("flaps_out", self.flaps_out, "residual of samples excluded because of flaps");
  field("notes", self.notes, "notes on the fit");
}

/// Fits the free coefficients of `model` to the flights with all references: the sum of their likelihoods,
/// each with a separate noise model. References that do not depend on a free coefficient are not used.
/// Results for a single residual are those of the first reference.
///
/// Coefficients: least squares with Huber loss of residuals in bins of four seconds, each bin weighted by the
/// square root of its sample count, each reference by the robust standard deviation of its residuals. Slow
/// misfit of the model is not treated as drift: the correction is the best one over all flown conditions.
/// From the input model the linear problem is solved in closed form, within the bounds; its
/// weights and derivatives are renewed until the loss is at its minimum. Every pass reduces each flight to a
/// triangular factor; the factors are combined.
///
/// Standard errors: M (N + F) M' with the derivatives M of the coefficients with respect to the residuals,
/// the covariance N of the noise (an autoregression with one level per five minutes, and drift, by restricted
/// likelihood) and the covariance F of the misfit of the model (`RefitResult::misfit_rms`), plus the
/// sensitivity to calibration errors of the reference and the thermometer (`RefitOptions::trust_reference`).
/// A jackknife error is reported with each.
///
/// Wind and heights are fitted after the other references, by a likelihood with winds, D-value and errors of
/// GPS as random processes (docs/gps.md). Coefficients of the other references and their covariance are the
/// prior; without other references the prior has the typical sizes of the effects about the start, and
/// directions in which delta-p would have an error above 1 hPa are fixed.
///
/// @throws Error if a flight cannot be read, a second static system reads the static pressure under test or
/// one computed from it, no parameter is free, no sample remains (with the masks), samples are fewer than
/// coefficients, bounds are empty, or coefficients are not identifiable together on these flights: the
/// message names them and the ones to fix.
RefitResult refit(const FlightSet& flights, const ModelDefinition& model, const References& references,
                  const RefitOptions& options = {});

/// Mean error of delta-p of a model, hPa.
struct LevelByGps {
  double missing = 0.0;  ///< correction of delta-p
  double standard_error = 0.0;

  bool is_determined() const { return standard_error < 1.0; }  // hPa
};

/// Constant error of the model's delta-p according to GPS, by the same likelihood as `refit`: static-constant
/// is fitted, added if the model lacks it, and all other coefficients are fixed. Empty without the references
/// wind and height.
/// @throws Error as `refit`
std::optional<LevelByGps> level_by_gps(const FlightSet& flights, const ModelDefinition& model,
                                       const References& references, const MaskOptions& mask = {});

/// Coefficients fitted to each flight separately, without held-out flights; empty for a flight that does not
/// determine them.
/// @throws Error if a flight cannot be read
std::vector<std::vector<FittedParameter>> refit_per_flight(const FlightSet& flights,
                                                           const ModelDefinition& model,
                                                           const References& references,
                                                           const RefitOptions& options = {});

}  // namespace pcor
