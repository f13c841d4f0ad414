#include <pcor/fit/refit.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <pcor/flight/same_aircraft.hpp>
#include <pcor/words/error.hpp>
#include "fit/before_and_after.hpp"
#include "fit/fit_covariance.hpp"
#include "fit/fitted_model.hpp"
#include "fit/identifiability.hpp"
#include "fit/omissions.hpp"
#include "fit/solver.hpp"
#include "numerics/missing.hpp"

namespace pcor {

using namespace internal;

namespace {

constexpr std::size_t passes_expected = 40;

using Sources = std::vector<FlightSource>;

void require_sense(const Sources& sources, const Reference& reference, const RefitOptions& options) {
  if (sources.empty()) throw Error("no flight to fit; give at least one");
  if (options.fit_reference && reference.model() == nullptr) {
    throw Error(
        "only a static system can be fitted together with the model; give --reference static:OTHER.toml");
  }
  if (!(options.training_share > 0.0 && options.training_share <= 1.0)) {
    throw Error("the share of samples that is fitted has to be above 0 and at most 1");
  }
}

/// All flights are of one aircraft, those that are held out too, and none is given twice.
void require_one_kind(const Sources& sources, const RefitOptions& options) {
  std::vector<std::filesystem::path> paths = options.holdout;
  for (const FlightSource& source : sources) {
    if (!source.samples) paths.push_back(source.path);
  }
  require_each_once(paths);
  std::vector<std::pair<std::string, std::string>> aircraft;
  const auto add = [&aircraft](const std::filesystem::path& path) {
    aircraft.emplace_back(path.filename().string(), Flight(path).aircraft());
  };
  for (const FlightSource& source : sources) {
    if (source.samples) {
      aircraft.emplace_back(source.samples->name, source.samples->aircraft);
    } else {
      add(source.path);
    }
  }
  for (const std::filesystem::path& path : options.holdout) add(path);
  require_one_aircraft(aircraft);
}

FitTask task_of(const ModelFile& model, const Reference& reference, const RefitOptions& options) {
  FitTask task{model, reference, options, fit_parameters(model, reference, options), {}, {}};
  task.start.resize(as_index(task.parameters.size()));
  for (std::size_t p = 0; p < task.parameters.size(); ++p) task.start[as_index(p)] = task.parameters[p].start;
  task.tell = [&progress = options.progress, passes = std::size_t{0}]() mutable {
    ++passes;
    if (progress) progress(std::min(passes, passes_expected - 1), passes_expected);
  };
  return task;
}

/// What the stages of a fit found, one after another.
struct Fitted {
  Solution solution{};
  std::vector<std::size_t> parameters{};  // in the order of the stages
  std::vector<int> stage_of{};            // of all parameters
  Eigen::MatrixXd earlier{};              // covariance of what stages before the last found
  std::unique_ptr<FitFlights> flights{};  // with all samples and all parameters that were fitted
};

Fitted fit_in_stages(const Sources& sources, const FitTask& task) {
  const std::vector<std::vector<std::size_t>> stages =
      fit_stages(task.parameters, task.options.stages, task.model.model.name);
  Fitted fitted;
  fitted.stage_of.resize(task.parameters.size(), 0);
  Solution& solution = fitted.solution;
  solution.values = task.start;
  for (std::size_t s = 0; s < stages.size(); ++s) {
    if (stages[s].empty()) continue;
    const bool last = s + 1 == stages.size();
    FitSetup setup{solution.values, stages[s]};
    if (!last) setup.regimes = task.options.stages[s].regimes;
    setup.with_offsets = !last;
    fitted.flights = std::make_unique<FitFlights>(sources, task, std::move(setup));
    solution = solve(*fitted.flights, std::move(solution));
    for (const std::size_t p : stages[s]) fitted.stage_of[p] = static_cast<int>(s) + 1;
    fitted.parameters.insert(fitted.parameters.end(), stages[s].begin(), stages[s].end());
    if (last) break;
    condition_number(fitted.flights->reduce(solution.values, solution.offsets, nullptr), task, stages[s]);
    const Eigen::MatrixXd own = fit_covariance(*fitted.flights, solution, Eigen::MatrixXd(0, 0)).matrix;
    const Eigen::Index size = fitted.earlier.rows() + own.rows();
    fitted.earlier.conservativeResizeLike(Eigen::MatrixXd::Zero(size, size));
    fitted.earlier.bottomRightCorner(own.rows(), own.rows()) = own;
  }
  // What comes now, errors, what can be told apart, and what each effect does, is of all samples.
  if (stages.size() > 1)
    fitted.flights =
        std::make_unique<FitFlights>(sources, task, FitSetup{solution.values, fitted.parameters});
  solution.offsets = Eigen::VectorXd();
  fitted.flights->measure_noise(solution.values, solution.offsets);
  solution.deviation = fitted.flights->deviation(solution.values, solution.offsets);
  return fitted;
}

/// The coefficients after the fit, and their covariance.
void list_coefficients(RefitResult& result, const FitTask& task, const Fitted& fitted,
                       const Eigen::MatrixXd& covariance) {
  for (std::size_t p = 0; p < task.parameters.size(); ++p) {
    FittedParameter& parameter = result.parameters.emplace_back();
    parameter.name = task.parameters[p].name;
    parameter.unit = task.parameters[p].unit;
    parameter.start = task.start[as_index(p)];
    parameter.value = fitted.solution.values[as_index(p)];
    parameter.standard_error = nan;
    parameter.stage = fitted.stage_of[p];
    parameter.fitted = parameter.stage > 0;
    parameter.at_bound = fitted.solution.at_bound[p];
  }
  for (std::size_t a = 0; a < fitted.parameters.size(); ++a) {
    FittedParameter& parameter = result.parameters[fitted.parameters[a]];
    const auto row = covariance.row(as_index(a));
    if (!parameter.at_bound) parameter.standard_error = std::sqrt(row[as_index(a)]);
    result.covariance_names.push_back(parameter.name);
    result.covariance.emplace_back(row.begin(), row.end());
  }
}

/// What a user should know, the gravest first.
std::vector<std::string> notes_of(const RefitResult& result, const FitTask& task, const Fitted& fitted,
                                  const Eigen::MatrixXd& covariance, const BeforeAndAfter& compared) {
  std::vector<std::string> notes;
  const auto add = [&notes](const std::vector<std::string>& more) {
    notes.insert(notes.end(), more.begin(), more.end());
  };
  if (result.rms > 1.02 * result.rms_before) {
    notes.push_back(
        fmt::format("the fit left a larger rms, {:.3f} hPa, than the coefficients of the file, {:.3f}: "
                    "what a stage held does not suit the rest, or outliers rule the rms",
                    result.rms, result.rms_before));
  }
  add(identifiability_notes(task, fitted.solution, covariance, fitted.parameters, result.condition_number,
                            compared.flown));
  add(compared.notes);
  add(bound_notes(task, fitted.solution, result.condition_number));
  if (task.uses_prior()) {
    notes.emplace_back(
        "every coefficient of an effect of the catalogue was drawn to its starting value by the typical size "
        "of its effect; two static systems alone tell only their difference, so how it is shared between "
        "them is what the starting values say");
  }
  return notes;
}

RefitResult fit(const Sources& sources, const ModelFile& model, const Reference& reference,
                const RefitOptions& options) {
  require_sense(sources, reference, options);
  require_one_kind(sources, options);
  const FitTask task = task_of(model, reference, options);
  const Fitted fitted = fit_in_stages(sources, task);
  const Solution& solution = fitted.solution;
  FitFlights& flights = *fitted.flights;

  RefitResult result;
  result.reference_text = reference.description();
  result.masks = flights.masks();
  result.condition_number =
      condition_number(flights.reduce(solution.values, solution.offsets, nullptr), task, fitted.parameters);
  const FitCovariance covariance = fit_covariance(flights, solution, fitted.earlier);
  result.samples_per_independent = covariance.samples_per_independent;
  const FitSums sums = sums_at(flights, solution.values, solution.deviation);
  result.samples = sums.samples;
  result.rms = sums.rms_of(sums.squares);
  result.rms_over_pressure = sums.rms_of(sums.relative_squares);
  result.bulk_rms = sums.rms_of(sums.bulk_squares);
  result.r_squared = sums.r_squared(sums.squares);
  result.outliers = sums.outliers;
  const SquaredResiduals squares(flights, solution);
  result.rms_before = sums.rms_of(squares.at(task.start));
  result.omissions = omissions(flights, solution, sums, squares);
  BeforeAndAfter compared = before_and_after(flights, solution.values);
  result.noise_rms = compared.noise_rms(result.samples);
  result.flights = std::move(compared.flights);
  list_coefficients(result, task, fitted, covariance.matrix);
  result.notes = notes_of(result, task, fitted, covariance.matrix, compared);
  result.model = fitted_model(model, 0, result, options.loss);
  if (options.fit_reference) {
    const auto own = std::accumulate(
        model.model.effects.begin(), model.model.effects.end(), std::size_t{0},
        [](std::size_t sum, const ModelEffect& effect) { return sum + effect.parameters.size(); });
    result.reference = fitted_model(*reference.model(), own, result, options.loss);
  }
  return result;
}

}  // namespace

RefitResult refit(const std::vector<std::filesystem::path>& flights, const ModelFile& model,
                  const Reference& reference, const RefitOptions& options) {
  Sources sources;
  for (const std::filesystem::path& path : flights) sources.push_back({path, nullptr});
  return fit(sources, model, reference, options);
}

RefitResult refit(const std::vector<std::shared_ptr<const FlightSamples>>& flights, const ModelFile& model,
                  const Reference& reference, const RefitOptions& options) {
  Sources sources;
  for (const std::shared_ptr<const FlightSamples>& samples : flights) sources.push_back({{}, samples});
  return fit(sources, model, reference, options);
}

}  // namespace pcor
