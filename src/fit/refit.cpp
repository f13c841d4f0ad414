#include <pcor/fit/refit.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/roles/add_effects.hpp>
#include "campaign/circular_pressure.hpp"
#include "campaign/model_parameters.hpp"
#include "fit/before_and_after.hpp"
#include "fit/fit_covariance.hpp"
#include "fit/fitted_model.hpp"
#include "fit/gps_fit.hpp"
#include "fit/identifiability.hpp"
#include "fit/omissions.hpp"
#include "fit/solver.hpp"
#include "fit/warnings.hpp"
#include "numerics/missing.hpp"
#include "parallel/workers.hpp"

namespace pcor {

using namespace internal;

template <class Archive>
void serialize(Archive& archive, FittedParameter& parameter) {
  archive(parameter.name, parameter.unit, parameter.start, parameter.value, parameter.standard_error,
          parameter.noise_error, parameter.jackknife_error, parameter.fitted, parameter.at_bound,
          parameter.stage);
}

namespace {

/// @throws Error if a static reference is the static pressure under test, or a second static system reads it
/// or one computed from it in the first flight: its noise and its errors cancel, and the fit would copy the
/// law of the second system.
void require_other_pressures(const FlightSet& flights, const ModelDefinition& model,
                             const References& references) {
  const std::string static_variable = model.variable_of(Quantity::static_pressure);
  for (const std::shared_ptr<const Reference>& reference : references) {
    const std::string other = circular_pressure(flights, model, *reference);
    // A pressure that the archive computed from the model's is a law, which a fit may copy.
    if (other.empty() || (reference->model() == nullptr && other != static_variable)) continue;
    throw Error(
        Error::Code::usage,
        fmt::format(
            "reference {}: its static pressure {} {} that of the model '{}', so a fit would be "
            "circular; give a system with an independent static pressure",
            reference->name(), other,
            other == static_variable ? std::string("is") : "is computed from " + static_variable + ",",
            model.model.name));
  }
}

void require_sense(const FlightSet& flights, const ModelDefinition& model, const References& references,
                   const RefitOptions& options) {
  if (flights.empty()) throw Error(Error::Code::usage, "no flight to fit; give at least one");
  if (flights.path(0).empty() && references.size() > 1)
    throw Error(Error::Code::usage,
                "samples in memory have the variables of one reference only; give one reference, or the "
                "paths of the flights");
  if (options.fit_reference && first_of(references).model() == nullptr) {
    throw Error(
        Error::Code::usage,
        "the first reference is not a static system, so it cannot be fitted with the model; give --reference "
        "static:OTHER.toml first");
  }
  if (!(options.training_share > 0.0 && options.training_share <= 1.0)) {
    throw Error(Error::Code::usage, fmt::format("the training share is {:g}, expected above 0 and at most 1",
                                                options.training_share));
  }
  const FlightSet all = flights.with(options.holdout);
  all.require_each_once();
  all.require_one_aircraft();
  require_other_pressures(flights, model, references);
}

/// Result of the stages of a fit.
struct Fitted {
  Solution solution{};
  std::vector<std::vector<std::size_t>> stages{};
  std::vector<std::size_t> parameters{};        // sorted by stage
  std::vector<std::size_t> fixed_with_error{};  // fixed parameters with an error stated in the files
  std::vector<int> stage_of{};                  // one per parameter
  std::shared_ptr<FitFlights> flights{};        // all samples and all parameters that were fitted
  std::vector<FitEquations> equations{};
  bool has_converged = true;

  FitSetup setup(const std::vector<Regime>& regimes = {}) const {
    return {solution.values, parameters, fixed_with_error, regimes};
  }
};

/// Iterates over the stages until no coefficient moves by a hundredth of its uncertainty. The weights are
/// those of all samples.
void repeat_stages(Fitted& fitted, const FitTask& task) {
  constexpr int max_rounds = 50;
  Solution& solution = fitted.solution;
  for (std::size_t s = 0; s < task.options.stages.size(); ++s) {
    const FitSetup setup = fitted.setup(task.options.stages[s].regimes);
    fitted.equations.push_back({std::make_shared<FitFlights>(task, setup), fitted.stages[s]});
  }
  fitted.equations.push_back({fitted.flights, fitted.stages.back()});
  fitted.has_converged = false;
  for (int round = 0; round < max_rounds && !fitted.has_converged; ++round) {
    const Eigen::VectorXd before = solution.values;
    // The weights hardly change after the first rounds.
    if (round < 2) {
      fitted.flights->weigh(solution.values);
      solution.deviation = fitted.flights->deviation(solution.values);
    }
    for (const FitEquations& each : fitted.equations) {
      each.flights->share_weight(*fitted.flights);
      if (each.parameters.empty()) continue;
      solution = solve(*each.flights, std::move(solution), each.parameters, true);
      if (round == 0)
        condition_number(each.flights->reduce(solution.values, {}, each.parameters), task, each.parameters);
    }
    const Eigen::VectorXd lengths = fitted.flights->reduce(solution.values, {}).lengths();
    const Eigen::VectorXd step = (solution.values - before)(fitted.parameters);
    fitted.has_converged = lengths.cwiseProduct(step).cwiseAbs().maxCoeff() < 0.01;
  }
}

/// Fit input, with the start as the solution.
Fitted at_start(const FitTask& task) {
  Fitted fitted;
  fitted.stages = fit_stages(task);
  fitted.stage_of.resize(task.parameters.size(), 0);
  for (std::size_t s = 0; s < fitted.stages.size(); ++s) {
    const std::vector<std::size_t>& stage = fitted.stages[s];
    for (const std::size_t p : stage) fitted.stage_of[p] = static_cast<int>(s) + 1;
    fitted.parameters.insert(fitted.parameters.end(), stage.begin(), stage.end());
  }
  for (std::size_t p = 0; p < task.parameters.size(); ++p) {
    if (fitted.stage_of[p] == 0 && task.stated_covariance(as_index(p), as_index(p)) > 0.0)
      fitted.fixed_with_error.push_back(p);
  }
  fitted.solution.values = task.start;
  fitted.solution.at_bound.resize(task.parameters.size(), false);
  return fitted;
}

/// The sizes of surfaces and their coefficients, in turn. The noise hardly changes after three rounds. The
/// coefficients are always those of the last sizes.
void fit_surfaces(FitTask& task, FitFlights& flights, Solution& solution) {
  constexpr int max_rounds = 6;
  constexpr int noise_rounds = 3;
  for (int round = 0; round < max_rounds; ++round) {
    const bool has_changed = find_roughness(flights, solution, task.surfaces, round < noise_rounds);
    solution = solve(flights, std::move(solution), flights.setup().requested);
    if (!has_changed) break;
  }
}

/// The subset of parameters that belongs to the model, not to the reference.
std::vector<std::size_t> parameters_of_model(const FitTask& task, std::vector<std::size_t> parameters) {
  const std::size_t count = parameter_count(task.model.model);
  parameters.erase(std::remove_if(parameters.begin(), parameters.end(),
                                  [count](std::size_t parameter) { return parameter >= count; }),
                   parameters.end());
  return parameters;
}

Fitted fit_in_stages(FitTask& task) {
  Fitted fitted = at_start(task);
  Solution& solution = fitted.solution;
  constexpr int max_masks = 3;
  for (int round = 0; round < max_masks; ++round) {
    fitted.flights = std::make_shared<FitFlights>(task, fitted.setup());
    // From there steps are short: a minimum of delta-p makes the residuals of two systems non-linear.
    const std::vector<std::size_t> of_model = parameters_of_model(task, fitted.parameters);
    if (task.options.fit_reference && round == 0 && !of_model.empty())
      solution = solve(*fitted.flights, std::move(solution), of_model);
    solution = solve(*fitted.flights, std::move(solution), fitted.parameters);
    if (!task.surfaces.empty()) fit_surfaces(task, *fitted.flights, solution);
    // The masks are those of the solution, so that the start does not decide.
    if (!fitted.flights->masks_change_at(solution.values)) break;
  }
  if (fitted.stages.size() > 1)
    repeat_stages(fitted, task);
  else
    fitted.equations.push_back({fitted.flights, fitted.parameters});
  return fitted;
}

/// The flights as the fit reads them, at the start, for references of GPS alone.
Fitted prepared_for_gps(const FitTask& task) {
  if (!task.options.stages.empty())
    throw Error(Error::Code::usage,
                "--stage: a fit to GPS alone has no stages; give a further reference, or omit --stage");
  if (task.options.use_prior)
    throw Error(
        Error::Code::usage,
        "--prior: a fit to GPS alone always has a prior about the start, with the typical sizes of the "
        "effects; "
        "omit --prior, or give a further reference");
  if (task.options.loss != RefitOptions().loss)
    throw Error(
        Error::Code::usage,
        fmt::format("--loss {}: a fit to GPS alone has no loss function, outliers get a larger variance; "
                    "omit --loss, or give a further reference",
                    to_string(task.options.loss)));
  Fitted fitted = at_start(task);
  for (const std::size_t p : fitted.parameters) {
    if (const SurfaceRoughness* const surface = task.surface_of(p)) {
      throw Error(
          Error::Code::fit,
          fmt::format("{}: wind and heights do not determine a surface; hold it with --fix {} or give a "
                      "further reference",
                      surface->effect, surface->effect));
    }
  }
  fitted.flights = std::make_shared<FitFlights>(task, fitted.setup());
  if (fitted.flights->samples() == 0) {
    throw Error(
        Error::Code::samples,
        fmt::format("no usable sample for the fit: {}; see the variables of the model and --min-airspeed, "
                    "--max-flaps, --exclude",
                    mask_text(fitted.flights->masks())));
  }
  return fitted;
}

/// Fits the result of the other references, if any, to GPS, and sets the covariance.
std::optional<GpsFit> add_gps(Fitted& fitted, const FitTask& task, FitCovariance& covariance,
                              bool is_masked_again = false) {
  std::vector<FitFlights*> by_gps;
  const bool is_alone = gps_kind(task.reference).has_value();
  if (is_alone) by_gps.push_back(fitted.flights.get());
  for (const std::unique_ptr<FitFlights>& each : fitted.flights->further()) {
    if (gps_kind(each->task().reference)) by_gps.push_back(each.get());
  }
  if (by_gps.empty()) return std::nullopt;
  Solution& solution = fitted.solution;
  GpsFit gps = fit_gps(by_gps, solution, covariance);
  if (!is_alone) return gps;
  if (!is_masked_again && fitted.flights->masks_change_at(solution.values)) {
    // The masks use the solution, so that the start does not matter.
    fitted.flights = std::make_shared<FitFlights>(task, fitted.setup());
    solution.values = task.start;
    covariance = {};
    return add_gps(fitted, task, covariance, true);
  }
  fitted.flights->measure_noise(solution.values);
  solution.deviation = fitted.flights->deviation(solution.values);
  return gps;
}

/// The coefficients after the fit, and their covariance.
void list_coefficients(RefitResult& result, const FitTask& task, const Fitted& fitted,
                       const FitCovariance& covariance) {
  for (std::size_t p = 0; p < task.parameters.size(); ++p) {
    const FitParameter& parameter = task.parameters[p];
    const int stage = fitted.stage_of[p];
    result.parameters.push_back({parameter.name, parameter.unit, task.start[as_index(p)],
                                 fitted.solution.values[as_index(p)], nan, nan, nan, stage > 0,
                                 fitted.solution.at_bound[p], stage});
  }
  const std::vector<std::size_t> all = fitted.setup().parameters();
  for (std::size_t a = 0; a < all.size(); ++a) {
    FittedParameter& parameter = result.parameters[all[a]];
    const auto row = covariance.matrix.row(as_index(a));
    if (parameter.fitted && !parameter.at_bound) {
      parameter.standard_error = std::sqrt(row[as_index(a)]);
      parameter.noise_error = std::sqrt(covariance.by_noise(as_index(a), as_index(a)));
      parameter.jackknife_error = covariance.jackknife[as_index(a)];
    }
    result.covariance_names.push_back(parameter.name);
    std::vector<double>& covariances = result.covariance.emplace_back(row.begin(), row.end());
    for (double& each : covariances) each += 0.0;  // no negative zero
  }
}

/// Adds the thermometer calibration to the covariance if the fit included its uncertainty: it also affects
/// temperature and airspeed of the corrected samples and partly cancels there.
void add_thermometer(RefitResult& result, const Fitted& fitted, const FitCovariance& covariance) {
  const ReferenceUncertainty& uncertainty = fitted.flights->uncertainty();
  for (std::size_t d = 0; d < uncertainty.names().size(); ++d) {
    const std::string& name = uncertainty.names()[d];
    const std::string effect = name.substr(0, name.find('.'));
    if (std::find(thermometer_calibration.begin(), thermometer_calibration.end(), effect) ==
        thermometer_calibration.end())
      continue;
    const auto column = std::find(covariance.uncertainties.begin(), covariance.uncertainties.end(), name);
    if (column == covariance.uncertainties.end()) continue;
    const double size = uncertainty.sizes()[as_index(d)];
    std::vector<double> row(result.covariance_names.size(), 0.0);
    for (std::size_t a = 0; a < fitted.parameters.size(); ++a)
      row[a] = size * covariance.by_uncertainty(as_index(a), column - covariance.uncertainties.begin());
    for (std::size_t a = 0; a < row.size(); ++a) result.covariance[a].push_back(row[a]);
    row.push_back(size * size);
    result.covariance.push_back(std::move(row));
    result.covariance_names.push_back(name);
  }
}

/// Warnings for the user, sorted by decreasing severity.
Notes notes_of(const RefitResult& result, const FitTask& task, const Fitted& fitted,
               const Eigen::MatrixXd& covariance, const std::optional<GpsFit>& gps,
               const BeforeAndAfter& compared) {
  Notes notes;
  const auto add = [&notes](const auto& more) { notes.insert(notes.end(), more.begin(), more.end()); };
  if (gps) add(gps->notes);
  if (!gps_kind(task.reference)) {
    add(identifiability_notes(task, fitted.solution, covariance, fitted.parameters, result.condition_number,
                              compared.flown));
    add(error_notes(result, fitted.flights->count(), fitted.has_converged,
                    task.uses_prior() || !fitted.fixed_with_error.empty()));
  }
  add(compared.notes);
  add(bound_notes(task, fitted.solution, result.condition_number));
  if (task.uses_prior()) {
    notes.emplace_back(
        "every coefficient has a Gaussian prior at its starting value; the covariance is that of the "
        "model file, otherwise the typical size of the effect, for a formula the value itself; combinations "
        "that the flights do not determine, such as the common error of two static systems, keep the "
        "starting value and the error of "
        "the prior");
  }
  return notes;
}

/// Description of the fitted references: "LAMS, hydrostatic height against that of GPS".
std::string reference_text(FitFlights& flights) {
  std::vector<std::string> descriptions;
  for (const FitFlights* const each : flights.joint())
    descriptions.push_back(each->task().reference.description());
  for (const std::unique_ptr<FitFlights>& each : flights.further()) {
    if (gps_kind(each->task().reference)) descriptions.push_back(each->task().reference.description());
  }
  return fmt::format("{}", fmt::join(descriptions, ", "));
}

/// Triangular factor of rows (derivatives, residual) of all references, in hPa, with equal weight for all
/// samples.
Reduction unweighted(FitFlights& flights, const Eigen::VectorXd& values) {
  TriangularFactor sum(as_index(flights.setup().requested.size()) + 1);
  for (FitFlights* const each : flights.joint()) sum.add(each->unweighted_factor(values));
  return {sum.factor(), Eigen::VectorXd::Zero(sum.columns() - 1)};
}

RefitResult fit(const FlightSet& fitted_flights, const ModelDefinition& model, const References& references,
                const RefitOptions& options) {
  const Reference& reference = first_of(references);
  FitTask task = fit_task(model, references, options, fitted_flights);
  const bool by_gps_alone = gps_kind(reference).has_value();
  Fitted fitted = by_gps_alone ? prepared_for_gps(task) : fit_in_stages(task);
  const Solution& solution = fitted.solution;
  RefitResult result;
  FitCovariance covariance;
  Misfit misfit;
  if (!by_gps_alone) {
    FitFlights& flights = *fitted.flights;
    misfit = find_misfit(flights, solution);
    // The weights are those at the solution from now on, of every stage.
    fitted.solution.deviation = flights.deviation(solution.values);
    for (const FitEquations& each : fitted.equations) {
      each.flights->share_weight(flights);
      each.flights->prepare(solution.values);
    }
    result.condition_number = condition_number(unweighted(flights, solution.values), task, fitted.parameters);
    covariance = fit_covariance(fitted.equations, solution, misfit);
  }
  const std::optional<GpsFit> gps = add_gps(fitted, task, covariance);
  if (by_gps_alone) {
    result.condition_number = gps->condition_number;
    result.autocorrelation_time = nan;
    result.estimator = refit_estimator_of_gps;
  }
  FitFlights& flights = *fitted.flights;  // uses masks of the solution
  if (gps) result.defect_error = gps->stated;
  result.reference_text = reference_text(flights);
  result.masks = flights.masks();
  result.jackknife_parts = covariance.blocks;
  const BeforeAndAfter compared =
      before_and_after(flights, solution.values, covariance.by_flights, misfit.rms, result);
  task.report_progress();
  const FitSums& sums = compared.sums;
  result.samples = sums.after.samples;
  // Unknown if samples have no residual with the input model.
  result.rms_before = sums.before.samples == sums.after.samples ? sums.rms_of(sums.before.squares) : nan;
  result.rms = sums.rms_of(sums.after.squares);
  result.rms_over_pressure = sums.rms_of(sums.relative_squares);
  result.bulk_rms = sums.rms_of(sums.bulk_squares);
  result.noise_rms = sums.rms_of(sums.after.noise_squares);
  if (covariance.information > 0.0) {
    const auto samples = static_cast<double>(result.samples);
    result.autocorrelation_time =
        std::max(samples / (sums.bulk_squares / samples * covariance.information), 1.0);
  }
  result.r_squared = sums.r_squared(sums.after.squares);
  result.outliers = flights.outliers(solution.values, tukey_width * solution.deviation);
  const SquaredResiduals squares(flights, solution);
  if (!gps) result.omissions = omissions(flights, solution, sums, squares);
  list_coefficients(result, task, fitted, covariance);
  add_thermometer(result, fitted, covariance);
  for (const SurfaceRoughness& surface : task.surfaces) {
    if (surface.degrees_of_freedom > 0.0)
      result.surfaces.push_back({surface.effect, surface.size, surface.degrees_of_freedom});
  }
  result.drift_rms = flights.drift_rms();
  result.misfit_rms = by_gps_alone ? nan : misfit.rms;
  result.between_flights = by_gps_alone ? nan : std::sqrt(misfit.between_flights);
  // Gusts are in the residual of the wind: a better law need not make it smaller.
  result.rejection_reason =
      why_worse(result, by_gps_alone ? infinity : sums.rms_of(sums.bulk_squares_before));
  result.least_squares_rms = gps ? nan : sums.rms_of(squares.minimum());
  // Gusts and drifts of the wind are not errors of the model.
  if (!by_gps_alone) result.warnings = fit_warnings(result, compared.longest_run);
  if (gps) result.warnings.insert(result.warnings.begin(), gps->warnings.begin(), gps->warnings.end());
  if (constexpr double much = 1.02; by_gps_alone && result.rms > much * result.rms_before) {
    result.warnings.push_back(
        fmt::format("compare the model with another reference before you use it: the rms increases from "
                    "{:.3f} to {:.3f} hPa; gusts can cause this",
                    result.rms_before, result.rms));
  }
  result.notes = notes_of(result, task, fitted, covariance.by_noise, gps, compared);
  result.model = fitted_model(model, 0, result, options.loss, fitted_flights.title());
  if (options.fit_reference) {
    result.reference = fitted_model(*reference.model(), parameter_count(model.model), result, options.loss,
                                    fitted_flights.title());
  }
  return result;
}

}  // namespace

ModelDefinition internal::fitted_coefficients(const FlightSet& flights, const ModelDefinition& model,
                                              const References& references, const RefitOptions& options,
                                              std::vector<SurfaceRoughness>& surfaces) {
  if (std::any_of(references.begin(), references.end(),
                  [](const auto& reference) { return gps_kind(*reference).has_value(); }))
    return refit(flights, model, references, options).model;
  require_sense(flights, model, references, options);
  FitTask task = fit_task(model, references, options, flights);
  if (!surfaces.empty()) task.surfaces = surfaces;
  const Fitted fitted = fit_in_stages(task);
  surfaces = task.surfaces;
  ModelDefinition result = model;
  Eigen::Index p = 0;
  for (ModelEffect& effect : result.model.effects) {
    for (double& value : effect.parameters) value = fitted.solution.values[p++];
  }
  return result;
}

RefitResult refit(const FlightSet& flights, const ModelDefinition& model, const References& references,
                  const RefitOptions& options) {
  require_sense(flights, model, references, options);
  References in_order = references;
  const auto gps = std::stable_partition(in_order.begin(), in_order.end(),
                                         [](const auto& reference) { return !gps_kind(*reference); });
  RefitResult result;
  try {
    result = fit(flights, model, in_order, options);
  } catch (const Error& error) {
    // The others are fitted before GPS, and have to determine all coefficients.
    const bool has_both = gps != in_order.begin() && gps != in_order.end();
    const bool is_for_others = !options.stages.empty() || options.fit_reference || options.use_prior ||
                               options.loss != RefitOptions().loss;
    const bool is_of_fit = error.code() == Error::Code::samples || error.code() == Error::Code::fit;
    if (!has_both || !is_of_fit || is_for_others) throw;
    result = fit(flights, model, References(gps, in_order.end()), options);
    result.notes.insert(result.notes.begin(),
                        fmt::format("fitted to {} alone, because the other references do not determine the "
                                    "coefficients: {}",
                                    result.reference_text, error.what()));
  }
  flights.with(options.holdout).require_unchanged();
  return result;
}

std::optional<LevelByGps> level_by_gps(const FlightSet& flights, const ModelDefinition& model,
                                       const References& references, const MaskOptions& mask) {
  References gps;
  std::copy_if(references.begin(), references.end(), std::back_inserter(gps),
               [](const auto& reference) { return gps_kind(*reference).has_value(); });
  if (gps.empty()) return std::nullopt;
  const std::string constant = "static-constant";
  ModelDefinition with = has_effect(model, constant) ? model : add_effects(model, {neutral_effect(constant)});
  // GPS alone is used, without the result of an earlier fit.
  with.covariance = {};
  for (EffectFit& fit : with.fits) {
    for (ParameterFit& parameter : fit) parameter.standard_error.reset();
  }
  RefitOptions options;
  options.mask = mask;
  for (const ModelEffect& effect : model.model.effects) {
    if (effect.id != constant && !effect.parameters.empty()) options.fix.push_back(effect.id);
  }
  options.free.push_back(constant);
  const RefitResult found = refit(flights, with, gps, options);
  for (const FittedParameter& parameter : found.parameters) {
    if (!parameter.fitted || !(parameter.standard_error > 0.0)) continue;
    const double pressure = found.defect_error / parameter.standard_error;
    return LevelByGps{pressure * (parameter.value - parameter.start), found.defect_error};
  }
  return std::nullopt;
}

std::vector<std::vector<FittedParameter>> refit_per_flight(const FlightSet& flights,
                                                           const ModelDefinition& model,
                                                           const References& references,
                                                           const RefitOptions& options) {
  const FlightPartition& partition = flights.partition();
  RefitOptions options_of_flight = options;
  options_of_flight.threads = Workers(flights.comm(), options.threads).threads;
  options_of_flight.holdout = FlightSet();
  options_of_flight.progress = nullptr;
  std::size_t done = 0;
  return partition.all_gather_flights<std::vector<FittedParameter>>([&](std::size_t number) {
    std::vector<FittedParameter> found;
    try {
      found = refit(flights.only(number), model, references, options_of_flight).parameters;
    } catch (const Error& error) {
      if (error.code() == Error::Code::file) throw;
    }
    if (options.progress) options.progress(++done, partition.local_count());
    return found;
  });
}

std::vector<FittedEffect> fitted_effects(const std::vector<FittedParameter>& parameters) {
  std::vector<FittedEffect> effects;
  for (const FittedParameter& parameter : parameters) {
    const std::size_t dot = parameter.name.rfind('.');
    const std::string id = parameter.name.substr(0, dot);
    if (effects.empty() || effects.back().id != id) effects.push_back({id});
    effects.back().parameters.push_back(parameter);
    effects.back().parameters.back().name = parameter.name.substr(dot + 1);
  }
  return effects;
}

}  // namespace pcor
