#include <pcor/fit/refit.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <thread>
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
  if (options.fit_reference && reference.kind != Reference::Kind::static_system) {
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

FitSetup setup_for(const FitTask& task, const Eigen::VectorXd& values, std::vector<std::size_t> wanted) {
  FitSetup setup;
  setup.model = &task.model;
  setup.reference = &task.reference;
  setup.mask = task.options.mask;
  setup.time_stamp = task.options.time_stamp;
  setup.training_share = task.options.training_share;
  setup.wanted = std::move(wanted);
  setup.values = values;
  setup.threads =
      task.options.threads != 0 ? task.options.threads : std::max(1U, std::thread::hardware_concurrency());
  setup.memory = task.options.memory;
  return setup;
}

/// The coefficients after the fit, and their covariance.
void list_coefficients(RefitResult& result, const FitTask& task, const Solution& solution,
                       const Eigen::MatrixXd& covariance, const std::vector<std::size_t>& fitted,
                       const std::vector<int>& stage_of) {
  for (std::size_t p = 0; p < task.parameters.size(); ++p) {
    FittedParameter& parameter = result.parameters.emplace_back();
    parameter.name = task.parameters[p].name;
    parameter.unit = task.parameters[p].unit;
    parameter.start = task.start[as_index(p)];
    parameter.value = solution.values[as_index(p)];
    parameter.standard_error = nan;
    parameter.stage = stage_of[p];
    parameter.fitted = parameter.stage > 0;
    parameter.at_bound = solution.at_bound[p];
  }
  for (std::size_t a = 0; a < fitted.size(); ++a) {
    FittedParameter& parameter = result.parameters[fitted[a]];
    const auto row = covariance.row(as_index(a));
    if (!parameter.at_bound) parameter.standard_error = std::sqrt(row[as_index(a)]);
    result.covariance_names.push_back(parameter.name);
    result.covariance.emplace_back(row.begin(), row.end());
  }
}

RefitResult fit(Sources sources, const ModelFile& model, const Reference& reference,
                const RefitOptions& options) {
  require_sense(sources, reference, options);
  require_one_kind(sources, options);
  const FitTask task = task_of(model, reference, options);
  const std::vector<std::vector<std::size_t>> stages =
      fit_stages(task.parameters, options.stages, model.model.name);

  std::vector<std::size_t> fitted;
  std::vector<int> stage_of(task.parameters.size(), 0);
  Eigen::MatrixXd earlier(0, 0);  // covariance of what stages before the last found
  Solution solution;
  solution.values = task.start;
  std::unique_ptr<FitFlights> all;
  for (std::size_t s = 0; s < stages.size() && !stages[s].empty(); ++s) {
    const bool last = s + 1 == stages.size();
    FitSetup setup = setup_for(task, solution.values, stages[s]);
    if (!last) {
      setup.regimes = options.stages[s].regimes;
      setup.with_offsets = true;
    }
    all = std::make_unique<FitFlights>(sources, std::move(setup));
    solution = solve(*all, task, std::move(solution));
    for (const std::size_t p : stages[s]) stage_of[p] = static_cast<int>(s) + 1;
    fitted.insert(fitted.end(), stages[s].begin(), stages[s].end());
    if (last) break;
    condition_number(all->reduce(solution.values, solution.offsets, nullptr), task, stages[s]);
    const Eigen::MatrixXd own = fit_covariance(*all, task, solution, Eigen::MatrixXd(0, 0)).matrix;
    const Eigen::Index before = earlier.rows();
    earlier.conservativeResizeLike(Eigen::MatrixXd::Zero(before + own.rows(), before + own.rows()));
    earlier.bottomRightCorner(own.rows(), own.rows()) = own;
  }
  // Everything that was fitted, over all samples: errors, what can be told apart, and what each effect does.
  if (stages.size() > 1)
    all = std::make_unique<FitFlights>(std::move(sources), setup_for(task, solution.values, fitted));
  FitFlights& flights = *all;
  solution.offsets = Eigen::VectorXd();
  flights.measure_noise(solution.values, solution.offsets);
  solution.deviation = flights.deviation(solution.values, solution.offsets);

  RefitResult result;
  result.reference_text = reference.description();
  result.masks = flights.masks();
  result.condition_number =
      condition_number(flights.reduce(solution.values, solution.offsets, nullptr), task, fitted);
  const FitCovariance covariance = fit_covariance(flights, task, solution, earlier);
  result.samples_per_independent = covariance.samples_per_independent;
  const FitSums sums = sums_at(flights, task, solution.values, solution.deviation);
  result.samples = sums.samples;
  result.rms = sums.rms_of(sums.squares);
  result.rms_over_pressure = sums.rms_of(sums.relative_squares);
  result.bulk_rms = sums.rms_of(sums.bulk_squares);
  result.r_squared = sums.r_squared(sums.squares);
  result.outliers = sums.outliers;
  const SquaredResiduals squares(flights, task, solution);
  result.rms_before = sums.rms_of(squares.at(task.start));
  result.omissions = omissions(flights, task, solution, sums, squares);
  BeforeAndAfter compared = before_and_after(flights, task, solution.values);
  result.noise_rms = compared.noise_rms(result.samples);
  result.flights = std::move(compared.flights);
  list_coefficients(result, task, solution, covariance.matrix, fitted, stage_of);

  const auto note = [&result](const std::vector<std::string>& words) {
    result.notes.insert(result.notes.end(), words.begin(), words.end());
  };
  if (result.rms > 1.02 * result.rms_before) {
    note(
        {fmt::format("the fit left a larger rms, {:.3f} hPa, than the coefficients of the file, {:.3f}: "
                     "what a stage held does not suit the rest, or outliers rule the rms",
                     result.rms, result.rms_before)});
  }
  note(what_is_not_told(task, solution, covariance.matrix, fitted, result.condition_number, compared.flown));
  note(compared.notes);
  note(what_is_at_bound(task, solution, result.condition_number));
  if (task.uses_prior()) {
    note(
        {"every coefficient of an effect of the catalogue was drawn to its starting value by the typical "
         "size "
         "of its effect; two static systems alone tell only their difference, so how it is shared between "
         "them is what the starting values say"});
  }
  result.model = fitted_model(model, 0, result, options.loss);
  if (options.fit_reference) {
    const auto own = std::accumulate(
        model.model.effects.begin(), model.model.effects.end(), std::size_t{0},
        [](std::size_t sum, const ModelEffect& effect) { return sum + effect.parameters.size(); });
    result.reference = fitted_model(*reference.system, own, result, options.loss);
  }
  return result;
}

}  // namespace

RefitResult refit(const std::vector<std::filesystem::path>& flights, const ModelFile& model,
                  const Reference& reference, const RefitOptions& options) {
  Sources sources;
  for (const std::filesystem::path& path : flights) sources.push_back({path, nullptr});
  return fit(std::move(sources), model, reference, options);
}

RefitResult refit(const std::vector<std::shared_ptr<const FlightSamples>>& flights, const ModelFile& model,
                  const Reference& reference, const RefitOptions& options) {
  Sources sources;
  for (const std::shared_ptr<const FlightSamples>& samples : flights) sources.push_back({{}, samples});
  return fit(std::move(sources), model, reference, options);
}

}  // namespace pcor
