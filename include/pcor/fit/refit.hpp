#pragma once

#include <pcor/campaign/flight_set.hpp>
#include <pcor/fit/loss.hpp>
#include <pcor/residuals/residuals.hpp>
#include <pcor/residuals/statistics.hpp>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcor {

/// A stage of a fit: some parameters from the samples of some regimes alone, each interval of which has an
/// offset of its own, of delta-p/p. So the memo found the sensitivities of its eq. 19 from manoeuvres. Stages
/// are repeated until no coefficient moves by a hundredth of its error.
struct FitStage {
  std::vector<Regime> regimes;
  std::vector<std::string> parameters;  ///< like "static-alpha.a1"; or an effect: all of its parameters
};

struct RefitOptions {
  MaskOptions mask;
  Loss loss = Loss::huber;
  std::vector<std::string> fix{};   ///< parameters, or effects, held besides those that the file fixes
  std::vector<std::string> free{};  ///< parameters, or effects, fitted although the file fixes them
  std::vector<FitStage> stages{};
  /// The model of a static system that is the reference is fitted together with the model.
  bool fit_reference = false;
  /// Effects of the model that the systems of the references have alike: they cancel where two systems are
  /// held against each other, and are left out there. A lag, for example, would be found there from the noise
  /// of both sensors alone.
  std::vector<std::string> alike{};
  /// Every coefficient is drawn to its starting value, as if that were measured: with the covariance that its
  /// file states, else to within the typical size of its effect. Always so where the reference is fitted too:
  /// two static systems tell only their difference, and what they have in common keeps its value, and the
  /// prior as its error.
  bool use_prior = false;
  /// The calibration of the references and of the thermometer counts as exact. Otherwise what it may be wrong
  /// by is part of the standard errors: `ParameterInfo::doubt`, or what `[uncertainty]` of the model states.
  bool trust_reference = false;
  /// Look for the start by a global search between the bounds, for parameters in which the residual is not
  /// linear.
  bool search = false;
  /// The fit uses the first part of every flight, this share of the samples; the rest is held out.
  double training_share = 1.0;
  FlightSet holdout{};  ///< flights that take no part in the fit
  /// Flights reduced at a time; 0: as many as processors, and one in a team of several.
  std::size_t threads = 0;
  std::function<void(std::size_t pass, std::size_t passes)> progress{};
};

/// A coefficient after the fit.
struct FittedParameter {
  std::string name;  ///< like "static-qp.a2"; of the reference's model "reference:static-qp.a2"
  std::string unit;
  double start = 0.0;
  double value = 0.0;
  /// With the memory and the slow drift of the noise, the misfit of the law, what held coefficients may err
  /// by, and the doubt of the reference's calibration; NaN where it was not fitted or is at a bound.
  double standard_error = 0.0;
  double noise_error = 0.0;  ///< the same without the misfit of the law and without the doubt
  /// The standard error that leaving out one flight, or one part of a flight, after another gives, without a
  /// model of the noise.
  double jackknife_error = 0.0;
  bool fitted = false;
  bool at_bound = false;
  int stage = 0;  ///< in which it was fitted, from 1; the last is that of all the rest
};

/// What the fit becomes without an effect, the others fitted again.
struct Omission {
  std::string effect;
  double rms = 0.0;  ///< hPa
  double r_squared = 0.0;
};

/// Result of the fit for one surface, in addition to its coefficients.
struct SurfaceFit {
  std::string effect;
  double roughness = 0.0;  ///< standard deviation of a second difference of Cp, by marginal likelihood
  double degrees_of_freedom = 0.0;  ///< number of coefficients that the flights determine
};

/// A flight in the fit, before and after.
struct FlightFit {
  std::string flight;
  bool holdout = false;
  Statistics before;
  Statistics after;
  double expected_bias = 0.0;  ///< `HeldOutPart::expected` of a part that was held out, hPa
  /// Fall of the squared residuals by the fit, in units of the noise, and its error from how it differs
  /// between minutes.
  double gain = 0.0;
  double gain_error = 0.0;
  std::string reference{};  ///< as `Reference::name` has it
};

/// Of the parts that were held out, that whose bias is largest compared with what the fit expects.
std::optional<HeldOutPart> worst_held_out(const std::vector<FlightFit>& flights);

/// How coefficients and errors are found, in a sentence.
inline constexpr std::string_view refit_estimator =
    "Coefficients by least squares with Huber's loss, four robust deviations wide; errors from the noise "
    "with its "
    "drift and from the misfit of the law.";
inline constexpr std::string_view refit_estimator_of_gps =
    "Coefficients by maximum likelihood, with winds, D-value and errors of GPS and instruments as random "
    "processes; errors from that likelihood or from the scatter of blocks of five minutes, the larger of "
    "both.";

struct RefitResult {
  ModelDefinition model;  ///< with coefficients, standard errors, covariance and provenance
  std::optional<ModelDefinition> reference{};  ///< of the reference's model, where it was fitted too
  std::vector<FittedParameter> parameters{};
  std::vector<std::string> covariance_names{};
  /// Of the fitted parameters, and of those that were held with a stated error, which the others carry;
  /// behind them of the calibration of the thermometer, like "temp-offset.offset", where it is in doubt.
  std::vector<std::vector<double>> covariance{};
  std::size_t samples = 0;
  double rms = 0.0;                ///< hPa, of all samples in the fit, outliers too
  double rms_over_pressure = 0.0;  ///< of residual over static pressure
  double bulk_rms = 0.0;           ///< robust deviation, hPa: without outliers
  double noise_rms = 0.0;          ///< of the noise floor, hPa
  double drift_rms = 0.0;          ///< of the slow parts of the noise, hPa: drift of the sensors
  /// Rms of what the law lacks as a smooth function of the flight state, hPa. The fitted model states it as
  /// the standard uncertainty of its delta-p in one sample.
  double left = 0.0;
  double least_squares_rms = 0.0;  ///< of plain least squares of the same samples, hPa; NaN where not known
  double r_squared = 0.0;
  double rms_before = 0.0;   ///< hPa, with the coefficients of the file
  std::size_t outliers = 0;  ///< samples that depart from what the noise allows after those before them
  /// Ratio of the largest to the smallest singular value of the derivatives, each column of length one.
  double condition_number = 0.0;
  double autocorrelation_time = 1.0;
  std::array<std::size_t, mask_count> masks{};
  std::size_t jackknife_parts = 0;  ///< flights, or parts of flights, that were left out one after another
  std::vector<Omission> omissions{};
  std::vector<SurfaceFit> surfaces{};
  std::vector<FlightFit> flights{};
  std::vector<FlightFit> further{};  ///< the same with each further reference, flight by flight
  Statistics
      flaps_out;  ///< of samples that are in no fit because flaps are out, with the fitted coefficients
  /// Standard error of delta-p by all fitted coefficients, hPa, rms over the flights; zero without the
  /// references wind and height.
  double defect_error = 0.0;
  std::string reference_text{};
  std::string_view estimator = refit_estimator;
  /// Why the model should not be used: the fit is worse than the coefficients of the file, or a held-out part
  /// is off by more than the fit expects. Empty otherwise.
  std::string worse{};
  std::vector<std::string> warnings{};  ///< why the fit should not be trusted, a sentence each
  std::vector<std::string> notes{};     ///< what a user should know, a sentence each, the gravest first
};

/// Fits the free coefficients of `model` to the flights, with all references at once: the sum of their
/// likelihoods, each with a noise of its own. A reference that no free coefficient changes takes no part.
/// Figures of the result that are of one residual are those of the first reference.
///
/// Coefficients: least squares with Huber's loss of residuals in bins of four seconds, each bin weighted by
/// the root of its samples, each reference by the robust deviation of its residuals. Slow misfit of the law
/// is not taken for drift: the correction is the best one over all that was flown. From the
/// coefficients of the file the linear problem is solved in closed form; then Ceres does the full one, with
/// bounds and loss. Every pass reduces each flight to a triangular factor, and the factors add up.
///
/// Standard errors: M (N + F) M' with the derivatives M of the coefficients by the residuals, the covariance
/// N of the noise (an autoregression whose level changes every five minutes, and slow drift, by restricted
/// likelihood) and the covariance F of the misfit of the law (`RefitResult::left`), and what the coefficients
/// would be if the reference and the thermometer were calibrated otherwise (`RefitOptions::trust_reference`);
/// beside each stands that of a jackknife.
///
/// Wind and heights are fitted after the other references, by a likelihood with winds, D-value and errors of
/// GPS as random processes (docs/gps.md). Coefficients of the other references and their covariance are the
/// prior; without other references the prior has the typical sizes of the effects about the start, and
/// directions in which delta-p would have an error above 1 hPa are held.
///
/// @throws Error if a flight cannot be read, nothing is free, no sample is left (with the masks), samples are
/// fewer than coefficients, bounds leave nothing, or coefficients cannot be told apart on these flights: the
/// message names them and says which to fix.
RefitResult refit(const FlightSet& flights, const ModelDefinition& model, const References& references,
                  const RefitOptions& options = {});

/// Mean error of delta-p of a model, hPa.
struct LevelByGps {
  double missing = 0.0;         ///< correction of delta-p
  double standard_error = 0.0;  ///< above 1 hPa the level is not determined
};

/// The constant part of the pressure that delta-p of the model lacks by GPS, with all other coefficients of
/// the model: by the same likelihood as `refit`. Empty without the references wind and height.
/// @throws Error as `refit`
std::optional<LevelByGps> level_by_gps(const FlightSet& flights, const ModelDefinition& model,
                                       const References& references, const MaskOptions& mask = {});

/// The coefficients as each flight alone finds them, without held-out flights; none of a flight that cannot
/// tell them.
/// @throws Error if a flight cannot be read
std::vector<std::vector<FittedParameter>> refit_per_flight(const FlightSet& flights,
                                                           const ModelDefinition& model,
                                                           const References& references,
                                                           const RefitOptions& options = {});

}  // namespace pcor
