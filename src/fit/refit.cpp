#include <pcor/fit/refit.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <numeric>
#include <thread>
#include <utility>

#include <pcor/effects/catalogue.hpp>
#include <pcor/flight/same_aircraft.hpp>
#include <pcor/words/error.hpp>
#include <pcor/words/suggest.hpp>
#include <pcor/words/utc.hpp>
#include "fit/fit_covariance.hpp"
#include "fit/fit_flights.hpp"
#include "fit/global_search.hpp"
#include "fit/minimise.hpp"
#include "fit/robust_loss.hpp"
#include "laws/covariance_blocks.hpp"
#include "numerics/bounded_least_squares.hpp"

namespace pcor {

using namespace internal;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

// Flights hold 32-bit floats: columns that agree to better than their rounding, 6e-8, are one column.
constexpr double hopeless_condition = 1e7;
// Column-scaled; that of the memo's eq. 20 with an independent Mach number is 1400 on a flight with speed
// runs.
constexpr double collinear_condition = 300.0;
// A standard error above this share of an effect's typical size is worth a word.
constexpr double weak_share = 0.25;
constexpr int most_omission_steps = 8;
constexpr int passes_expected = 40;

/// What a fit knows of one parameter beside its value.
struct ParameterState {
  std::string name;
  std::string effect;  // with the prefix of the reference
  std::string unit;
  double neutral = 0.0;
  double typical = 0.0;
  std::string_view manoeuvre{};
  Bounds bounds;
  bool fixed = false;
};

/// The sums behind rms and R^2 of the samples of a fit.
struct FitSums {
  double squares = 0.0;
  double bulk_squares = 0.0;  // of the robust deviation
  double relative_squares = 0.0;
  double wanted = 0.0;
  double wanted_squares = 0.0;
  std::size_t samples = 0;
  std::size_t outliers = 0;

  void add(const FitSums& other) {
    squares += other.squares;
    bulk_squares += other.bulk_squares;
    relative_squares += other.relative_squares;
    wanted += other.wanted;
    wanted_squares += other.wanted_squares;
    samples += other.samples;
    outliers += other.outliers;
  }
  double bulk_rms() const { return std::sqrt(bulk_squares / static_cast<double>(samples)); }
  double rms() const { return std::sqrt(squares / static_cast<double>(samples)); }
  double r_squared() const { return r_squared(squares); }
  /// Of another model with that sum of squared residuals.
  double r_squared(double other_squares) const {
    return 1.0 - other_squares / (wanted_squares - wanted * wanted / static_cast<double>(samples));
  }
};

std::string name_of(const FlightSource& source) {
  return source.samples ? source.samples->name : source.path.string();
}

class Refit {
 public:
  Refit(std::vector<FlightSource> sources, const ModelFile& model, const Reference& reference,
        const RefitOptions& options)
      : sources_(std::move(sources)), model_(model), reference_(reference), options_(options) {}

  RefitResult run();

 private:
  struct Solution {
    double deviation = 1.0;
    Eigen::VectorXd offsets;
    std::vector<bool> at_bound;  // of the wanted parameters
  };

  void require_one_kind() const;
  void list_parameters();
  std::vector<std::size_t> parameters_named(const std::string& name, const char* option) const;
  std::vector<std::vector<std::size_t>> stages();
  FitSetup setup_for(std::vector<std::size_t> wanted) const;
  void require_samples(const FitFlights& flights) const;
  Solution solve(FitFlights& flights);
  double memory_of(FitFlights& flights, const Eigen::VectorXd& offsets);
  Eigen::VectorXd prior_weights(const FitSetup& setup) const;
  Eigen::MatrixXd covariance(FitFlights& flights, const Solution& solution, const Eigen::MatrixXd& earlier);
  Eigen::MatrixXd parameter_factor(const Reduction& reduction, std::size_t wanted) const;
  void require_rank(const Reduction& reduction, const std::vector<std::size_t>& wanted);
  FitSums sums_at(FitFlights& flights, const Eigen::VectorXd& parameters, double deviation);
  void find_omissions(FitFlights& flights, const Solution& solution, const FitSums& sums);
  void compare_flights(FitFlights& flights);
  std::vector<FlightFit> before_and_after(const Residuals& residuals, double training_share) const;
  void list_results(const Eigen::MatrixXd& errors, const std::vector<std::size_t>& fitted,
                    const std::vector<int>& stage_of, const std::vector<bool>& at_bound);
  void explain_errors(const Eigen::MatrixXd& covariance, const std::vector<std::size_t>& wanted);
  void write_models(const Eigen::MatrixXd& covariance, const std::vector<std::size_t>& fitted);
  void tell();

  bool uses_prior() const { return options_.use_prior || options_.fit_reference; }

  /// The weight of a parameter's starting value; zero without a prior.
  double prior_weight_of(std::size_t parameter) const {
    const double typical = parameters_[parameter].typical;
    return typical > 0.0 ? prior_strength_ / typical : 0.0;
  }

  std::vector<FlightSource> sources_;
  const ModelFile& model_;
  const Reference& reference_;
  const RefitOptions& options_;
  std::vector<ParameterState> parameters_;
  std::size_t own_parameters_ = 0;
  Eigen::VectorXd start_;
  Eigen::VectorXd values_;
  RefitResult result_;
  double prior_strength_ = 0.0;  // weight of a starting value that is off by its typical size
  RegimeSet flown_;              // in the flights of the fit
  std::size_t passes_ = 0;
};

void Refit::tell() {
  ++passes_;
  if (options_.progress)
    options_.progress(std::min<std::size_t>(passes_, passes_expected - 1), passes_expected);
}

/// All flights are of one aircraft, those that are held out too, and none is given twice.
void Refit::require_one_kind() const {
  std::vector<std::filesystem::path> paths = options_.holdout;
  for (const FlightSource& source : sources_) {
    if (!source.samples) paths.push_back(source.path);
  }
  require_each_once(paths);
  std::vector<std::pair<std::string, std::string>> aircraft;
  const auto add = [&aircraft](const std::filesystem::path& path) {
    aircraft.emplace_back(path.filename().string(), Flight(path).aircraft());
  };
  for (const FlightSource& source : sources_) {
    if (source.samples) {
      aircraft.emplace_back(source.samples->name, source.samples->aircraft);
    } else {
      add(source.path);
    }
  }
  for (const std::filesystem::path& path : options_.holdout) add(path);
  require_one_aircraft(aircraft);
}

void Refit::list_parameters() {
  const auto add = [this](const ModelFile& file, const std::string& prefix, bool fitted) {
    for (std::size_t e = 0; e < file.model.effects.size(); ++e) {
      const ModelEffect& effect = file.model.effects[e];
      const std::vector<std::string> names = parameter_names(effect);
      for (std::size_t p = 0; p < names.size(); ++p) {
        ParameterState state;
        state.effect = prefix + effect.id;
        state.name = state.effect + "." + names[p];
        state.bounds = file.bounds(e, p);
        state.fixed = !fitted || file.fit(e, p).fixed;
        if (!effect.is_formula()) {
          const EffectFacts& facts = effect_facts[effect_named(effect.id)];
          state.unit = facts.parameters[p].unit;
          state.neutral = facts.parameters[p].neutral;
          state.typical = std::abs(facts.parameters[p].typical);
          state.manoeuvre = facts.manoeuvre;
        }
        parameters_.push_back(std::move(state));
      }
    }
  };
  add(model_, "", true);
  own_parameters_ = parameters_.size();
  if (reference_.kind == Reference::Kind::static_system)
    add(*reference_.system, "reference:", options_.fit_reference);
  for (const std::string& name : options_.free) {
    for (const std::size_t p : parameters_named(name, "--free")) parameters_[p].fixed = false;
  }
  for (const std::string& name : options_.fix) {
    for (const std::size_t p : parameters_named(name, "--fix")) parameters_[p].fixed = true;
  }
}

std::vector<std::size_t> Refit::parameters_named(const std::string& name, const char* option) const {
  std::vector<std::size_t> found;
  std::vector<std::string> known;
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    if (parameters_[p].name == name || parameters_[p].effect == name) found.push_back(p);
    known.push_back(parameters_[p].name);
  }
  if (!found.empty()) return found;
  const std::string meant = did_you_mean(name, known);
  throw Error(fmt::format("{} {}: the model has no such parameter or effect; {}", option, name,
                          meant.empty() ? fmt::format("it has {}", fmt::join(known, ", ")) : meant));
}

/// The parameters that each stage fits, the last one what is left.
std::vector<std::vector<std::size_t>> Refit::stages() {
  std::vector<std::vector<std::size_t>> result;
  std::vector<bool> left(parameters_.size());
  for (std::size_t p = 0; p < parameters_.size(); ++p) left[p] = !parameters_[p].fixed;
  if (std::none_of(left.begin(), left.end(), [](bool free) { return free; })) {
    throw Error(
        fmt::format("model '{}': no coefficient is free; add an effect, or free one with --free EFFECT",
                    model_.model.name));
  }
  for (const FitStage& stage : options_.stages) {
    std::vector<std::size_t> wanted;
    for (const std::string& name : stage.parameters) {
      for (const std::size_t p : parameters_named(name, "--stage")) {
        if (!left[p])
          throw Error(fmt::format("--stage: {} is fixed, or fitted in a stage before", parameters_[p].name));
        left[p] = false;
        wanted.push_back(p);
      }
    }
    result.push_back(std::move(wanted));
  }
  std::vector<std::size_t> rest;
  for (std::size_t p = 0; p < left.size(); ++p) {
    if (left[p]) rest.push_back(p);
  }
  result.push_back(std::move(rest));
  return result;
}

FitSetup Refit::setup_for(std::vector<std::size_t> wanted) const {
  FitSetup setup;
  setup.model = &model_;
  setup.reference = &reference_;
  setup.mask = options_.mask;
  setup.time_stamp = options_.time_stamp;
  setup.training_share = options_.training_share;
  setup.wanted = std::move(wanted);
  setup.values = values_;
  setup.threads =
      options_.threads != 0 ? options_.threads : std::max(1U, std::thread::hardware_concurrency());
  setup.memory = options_.memory;
  return setup;
}

void Refit::require_samples(const FitFlights& flights) const {
  const FitSetup& setup = flights.setup();
  if (flights.samples() == 0 && !setup.regimes.empty()) {
    std::vector<std::string_view> names;
    for (const Regime regime : setup.regimes) names.push_back(facts_of(regime).name);
    throw Error(
        fmt::format("--stage: the flights have no {}; fit without the stage, or give the intervals in a file "
                    "with --intervals",
                    fmt::join(names, " or ")));
  }
  if (flights.samples() == 0) {
    throw Error(fmt::format(
        "{}: no sample is left for the fit: {}; see the variables of the model and --min-airspeed, "
        "--max-flaps, --exclude",
        sources_.size() == 1 ? name_of(sources_.front()) : "the flights", mask_text(flights.masks())));
  }
  const std::size_t unknown = setup.wanted.size() + flights.offsets();
  if (flights.samples() <= unknown) {
    throw Error(
        fmt::format("{} samples are too few for {} coefficients (not used: {}); give more flights or fix "
                    "coefficients",
                    flights.samples(), unknown, mask_text(flights.masks())));
  }
}

/// For how many samples one independent one stands in the residuals at hand: what a starting value is weighed
/// against.
double Refit::memory_of(FitFlights& flights, const Eigen::VectorXd& offsets) {
  std::vector<double> memory(flights.count(), 0.0);
  flights.visit([&](std::size_t number, std::size_t first_offset, FitFlight& fit) {
    const FlightSamples& samples = fit.residuals().samples();
    const std::vector<double> values = fit.values(values_, offsets.data() + first_offset);
    if (values.empty()) return;
    std::vector<double> series(samples.time.size(), nan);
    double squares = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      series[fit.kept()[i]] = values[i] / fit.noise(i);
      squares += series[fit.kept()[i]] * series[fit.kept()[i]];
    }
    const auto count = static_cast<double>(values.size());
    const Autoregression noise = autoregression(series, stretches_of(series, samples.time, samples.step));
    memory[number] = count * noise.samples_per_independent(std::sqrt(squares / count));
  });
  const double sum = std::accumulate(memory.begin(), memory.end(), 0.0);
  return std::max(sum / static_cast<double>(flights.samples()), 1.0);
}

Refit::Solution Refit::solve(FitFlights& flights) {
  const FitSetup& setup = flights.setup();
  require_samples(flights);
  const std::size_t fitted = setup.wanted.size();
  Solution solution;
  solution.offsets = Eigen::VectorXd::Zero(as_index(flights.offsets()));
  const auto clamped = [&](std::size_t k, double value) {
    const Bounds& bounds = parameters_[setup.wanted[k]].bounds;
    return std::clamp(value, bounds.lower, bounds.upper);
  };
  Eigen::VectorXd x(as_index(fitted + flights.offsets()));
  const auto spread = [&] {
    for (std::size_t k = 0; k < fitted; ++k) values_[as_index(setup.wanted[k])] = x[as_index(k)];
    solution.offsets = x.tail(as_index(flights.offsets()));
  };
  x.setZero();
  for (std::size_t k = 0; k < fitted; ++k) x[as_index(k)] = clamped(k, values_[as_index(setup.wanted[k])]);
  spread();

  if (options_.search) {
    std::vector<SearchRange> ranges;
    for (const std::size_t p : setup.wanted)
      ranges.push_back({parameters_[p].name, parameters_[p].bounds.lower, parameters_[p].bounds.upper});
    x = global_search(flights, setup, values_, flights.is_linear(), ranges, [this] { tell(); });
    spread();
  }
  // The linear problem, in closed form: where derivatives do not depend on the coefficients, its solution.
  // Gives the cost before the step.
  const auto linear_step = [&](const ceres::LossFunction* loss) {
    const Reduction reduction = flights.reduce(values_, solution.offsets, loss);
    tell();
    const Eigen::Index size = x.size();
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2 * size, size);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * size);
    rows.topRows(size) = reduction.factor.topLeftCorner(size, size);
    right.head(size) = -reduction.factor.col(size).head(size);
    for (std::size_t k = 0; k < fitted; ++k) {
      const double weight = prior_weight_of(setup.wanted[k]);
      rows(size + as_index(k), as_index(k)) = weight;
      right[size + as_index(k)] = weight * (start_[as_index(setup.wanted[k])] - x[as_index(k)]);
    }
    if (!rows.allFinite() || !right.allFinite()) return infinity;
    Eigen::VectorXd lower = Eigen::VectorXd::Constant(size, -infinity);
    Eigen::VectorXd upper = Eigen::VectorXd::Constant(size, infinity);
    for (std::size_t k = 0; k < fitted; ++k) {
      lower[as_index(k)] = parameters_[setup.wanted[k]].bounds.lower;
      upper[as_index(k)] = parameters_[setup.wanted[k]].bounds.upper;
    }
    x = bounded_least_squares(rows, right + rows * x, lower, upper, x);
    spread();
    return reduction.cost;
  };
  if (!uses_prior()) linear_step(nullptr);
  flights.measure_noise(values_, solution.offsets);
  solution.deviation = flights.deviation(values_, solution.offsets);

  if (uses_prior()) {
    // The samples count by their noise and memory, which only the residuals of a fit show: again until they
    // agree.
    for (int round = 0; round < 10; ++round) {
      const double before = prior_strength_;
      prior_strength_ = std::sqrt(memory_of(flights, solution.offsets)) * solution.deviation;
      if (std::abs(prior_strength_ - before) < 0.05 * before) break;
      linear_step(nullptr);
      flights.measure_noise(values_, solution.offsets);
      solution.deviation = flights.deviation(values_, solution.offsets);
    }
  }
  Prior prior;
  prior.weight = prior_weights(setup);
  if (prior.weight.size() > 0) {
    prior.weight.conservativeResizeLike(Eigen::VectorXd::Zero(x.size()));
    prior.start = x;
    for (std::size_t k = 0; k < fitted; ++k) prior.start[as_index(k)] = start_[as_index(setup.wanted[k])];
  }
  std::vector<Bounds> bounds;
  for (const std::size_t p : setup.wanted) bounds.push_back(parameters_[p].bounds);
  const auto touches = [&](std::size_t k) {
    const double near = 1e-9 * std::max(std::abs(x[as_index(k)]), 1e-12);
    return x[as_index(k)] <= bounds[k].lower + near || x[as_index(k)] >= bounds[k].upper - near;
  };
  const auto is_at_bound = [&] {
    for (std::size_t k = 0; k < fitted; ++k) {
      if (touches(k)) return true;
    }
    return false;
  };
  const auto fit_with = [&](Loss loss) {
    const std::unique_ptr<ceres::LossFunction> function = loss_function(loss, solution.deviation);
    minimise(
        flights, values_, function.get(), prior, bounds, [this] { tell(); }, x);
    spread();
    // Along a bound, where coefficients are nearly collinear, steps cut off at the bounds stall before the
    // minimum; steps that know the bounds go on.
    double cost = infinity;
    Eigen::VectorXd best = x;
    for (int step = 0; step < 20 && is_at_bound(); ++step) {
      const Eigen::VectorXd now = x;
      const double cost_now = linear_step(function.get());
      if (!(cost_now < (1.0 - 1e-10) * cost)) break;
      cost = cost_now;
      best = now;
    }
    x = best;
    spread();
    const double before = solution.deviation;
    solution.deviation = flights.deviation(values_, solution.offsets);
    tell();
    return std::abs(solution.deviation - before) < 1e-3 * before;
  };
  if (options_.loss == Loss::none) {
    fit_with(Loss::none);
  } else {
    // The solution of a convex loss is unique; from Huber's the others find the minimum of the bulk.
    if (options_.loss == Loss::tukey || options_.loss == Loss::cauchy) fit_with(Loss::huber);
    for (int round = 0; round < 5 && !fit_with(options_.loss); ++round) {
    }
  }
  solution.at_bound.resize(fitted);
  for (std::size_t k = 0; k < fitted; ++k) solution.at_bound[k] = touches(k);
  return solution;
}

/// The factor of the wanted parameters alone, with what the offsets explain taken out.
Eigen::MatrixXd Refit::parameter_factor(const Reduction& reduction, std::size_t wanted) const {
  const Eigen::Index size = reduction.factor.cols() - 1;
  const Eigen::Index count = as_index(wanted);
  Eigen::MatrixXd turned(size, size);
  turned.leftCols(size - count) = reduction.factor.block(0, count, size, size - count);
  turned.rightCols(count) = reduction.factor.block(0, 0, size, count);
  const Eigen::HouseholderQR<Eigen::MatrixXd> decomposition(turned);
  const Eigen::MatrixXd upper = decomposition.matrixQR().triangularView<Eigen::Upper>();
  return upper.bottomRightCorner(count, count);
}

void Refit::require_rank(const Reduction& reduction, const std::vector<std::size_t>& wanted) {
  Eigen::MatrixXd scaled = parameter_factor(reduction, wanted.size());
  for (Eigen::Index k = 0; k < scaled.cols(); ++k) {
    const double length = scaled.col(k).norm();
    const std::string& name = parameters_[wanted[static_cast<std::size_t>(k)]].name;
    const double with_offsets = reduction.factor.col(k).norm();
    if (!(with_offsets > 0.0)) {
      throw Error(fmt::format(
          "{} changes nothing on these flights, so it cannot be found; leave it as it is: --fix {}", name,
          name));
    }
    if (!(length > with_offsets / hopeless_condition)) {
      throw Error(fmt::format(
          "--stage: {} cannot be told from the offsets of the intervals; leave it to the last stage", name));
    }
    scaled.col(k) /= length;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> decomposition(scaled, Eigen::ComputeFullV);
  const Eigen::VectorXd& singular = decomposition.singularValues();
  const double condition = singular[0] / singular[singular.size() - 1];
  result_.condition_number = std::isfinite(condition) ? condition : infinity;
  if (condition < hopeless_condition || uses_prior()) return;
  const Eigen::VectorXd weak = decomposition.matrixV().col(singular.size() - 1).cwiseAbs();
  std::vector<std::string> names;
  for (Eigen::Index k = 0; k < weak.size(); ++k) {
    if (weak[k] > 0.1 * weak.maxCoeff())
      names.push_back(parameters_[wanted[static_cast<std::size_t>(k)]].name);
  }
  throw Error(
      fmt::format("{} cannot all be free on these flights: what one does the others undo (condition number "
                  "{:.0e}); hold one of them, e.g. --fix {}",
                  fmt::join(names, ", "), result_.condition_number, names.back()));
}

/// Of the wanted parameters; empty without a prior.
Eigen::VectorXd Refit::prior_weights(const FitSetup& setup) const {
  if (!(prior_strength_ > 0.0)) return {};
  Eigen::VectorXd weights(as_index(setup.wanted.size()));
  for (std::size_t k = 0; k < setup.wanted.size(); ++k)
    weights[as_index(k)] = prior_weight_of(setup.wanted[k]);
  return weights;
}

Eigen::MatrixXd Refit::covariance(FitFlights& flights, const Solution& solution,
                                  const Eigen::MatrixXd& earlier) {
  const std::unique_ptr<ceres::LossFunction> loss = loss_function(options_.loss, solution.deviation);
  FitCovariance found = fit_covariance(flights, values_, solution.offsets, loss.get(), earlier,
                                       solution.at_bound, prior_weights(flights.setup()), prior_strength_);
  result_.samples_per_independent = found.samples_per_independent;
  return std::move(found.matrix);
}

FitSums Refit::sums_at(FitFlights& flights, const Eigen::VectorXd& parameters, double deviation) {
  std::vector<FitSums> parts(flights.count());
  flights.visit([&](std::size_t number, std::size_t, FitFlight& fit) {
    // The reference's delta-p by its own file, so that R2 does not grow with a reference that is fitted too.
    const std::vector<double> wanted = fit.residuals().wanted_defect(start_.data());
    const std::vector<double> all = fit.residuals().values(parameters.data());
    std::vector<double> residual;
    for (const std::size_t i : fit.kept()) residual.push_back(all[i]);
    FitSums& sums = parts[number];
    sums.samples = fit.kept().size();
    for (std::size_t i = 0; i < residual.size(); ++i) {
      const double relative = residual[i] / fit.static_pressure(i);
      const double defect = wanted[fit.kept()[i]];
      sums.squares += residual[i] * residual[i];
      sums.relative_squares += relative * relative;
      sums.wanted += defect;
      sums.wanted_squares += defect * defect;
      if (std::abs(residual[i]) > tukey_width * deviation * fit.noise(i)) ++sums.outliers;
    }
    const double bulk = robust_deviation(residual);
    if (sums.samples > 0) sums.bulk_squares = bulk * bulk * static_cast<double>(sums.samples);
  });
  FitSums whole;
  for (const FitSums& part : parts) whole.add(part);
  tell();
  return whole;
}

/// What the fit becomes without each effect: its parameters go to their neutral values and the others follow,
/// with the weights that the samples have.
void Refit::find_omissions(FitFlights& flights, const Solution& solution, const FitSums& sums) {
  const FitSetup& setup = flights.setup();
  const std::unique_ptr<ceres::LossFunction> loss = loss_function(options_.loss, solution.deviation);
  const Eigen::Index size = as_index(setup.wanted.size());
  // Rows of derivatives and residual at some coefficients, with what draws these to their start.
  const auto rows_at = [&](const Eigen::VectorXd& parameters) {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2 * size, size + 1);
    rows.topRows(size) = flights.reduce(parameters, Eigen::VectorXd(), loss.get()).factor.topRows(size);
    for (Eigen::Index k = 0; k < size; ++k) {
      const std::size_t p = setup.wanted[static_cast<std::size_t>(k)];
      rows(size + k, k) = prior_weight_of(p);
      rows(size + k, size) = prior_weight_of(p) * (parameters[as_index(p)] - start_[as_index(p)]);
    }
    tell();
    return rows;
  };
  const Eigen::MatrixXd rows_of_fit = rows_at(values_);
  // Where the residual is linear in all, one factor tells the squares at any coefficients.
  const bool linear = std::all_of(setup.wanted.begin(), setup.wanted.end(),
                                  [&](std::size_t p) { return flights.is_linear()[p]; });
  const Eigen::MatrixXd unweighted = linear ? flights.unweighted_factor(values_) : Eigen::MatrixXd();
  const auto squares_of = [&](const Eigen::VectorXd& parameters) {
    if (!linear) return sums_at(flights, parameters, solution.deviation).squares;
    Eigen::VectorXd step = Eigen::VectorXd::Ones(size + 1);
    for (Eigen::Index k = 0; k < size; ++k) {
      const Eigen::Index p = as_index(setup.wanted[static_cast<std::size_t>(k)]);
      step[k] = parameters[p] - values_[p];
    }
    return (unweighted * step).squaredNorm();
  };
  result_.rms_before = std::sqrt(squares_of(start_) / static_cast<double>(sums.samples));
  std::vector<std::string> effects;
  for (const std::size_t p : setup.wanted) {
    const std::string& effect = parameters_[p].effect;
    if (std::find(effects.begin(), effects.end(), effect) == effects.end()) effects.push_back(effect);
  }
  for (const std::string& effect : effects) {
    std::vector<Eigen::Index> others;
    Eigen::VectorXd away = Eigen::VectorXd::Zero(size);
    Eigen::VectorXd changed = values_;
    for (Eigen::Index k = 0; k < size; ++k) {
      const std::size_t p = setup.wanted[static_cast<std::size_t>(k)];
      if (parameters_[p].effect != effect) {
        others.push_back(k);
        continue;
      }
      away[k] = parameters_[p].neutral - values_[as_index(p)];
      changed[as_index(p)] = parameters_[p].neutral;
    }
    Eigen::VectorXd lower(as_index(others.size()));
    Eigen::VectorXd upper(as_index(others.size()));
    Eigen::VectorXd x(as_index(others.size()));
    for (std::size_t i = 0; i < others.size(); ++i) {
      const std::size_t p = setup.wanted[static_cast<std::size_t>(others[i])];
      lower[as_index(i)] = parameters_[p].bounds.lower;
      upper[as_index(i)] = parameters_[p].bounds.upper;
      x[as_index(i)] = values_[as_index(p)];
    }
    // From the fit one step leads to the least squares where all is linear; else a few do.
    for (int round = 0; round < (linear ? 1 : most_omission_steps) && !others.empty(); ++round) {
      const Eigen::MatrixXd rows = round == 0 ? rows_of_fit : rows_at(changed);
      const Eigen::MatrixXd columns = rows(Eigen::all, others);
      Eigen::VectorXd right = columns * x - rows.col(size);
      if (round == 0) right -= rows.leftCols(size) * away;
      if (!right.allFinite()) break;
      const Eigen::VectorXd before = x;
      x = bounded_least_squares(columns, right, lower, upper, x);
      for (std::size_t i = 0; i < others.size(); ++i)
        changed[as_index(setup.wanted[static_cast<std::size_t>(others[i])])] = x[as_index(i)];
      if ((x - before).norm() < 1e-6 * x.norm()) break;
    }
    const double squares = squares_of(changed);
    result_.omissions.push_back(
        {effect, std::sqrt(squares / static_cast<double>(sums.samples)), sums.r_squared(squares)});
  }
}

/// A flight with the coefficients of the file and with those of the fit: the part that was fitted, the first
/// `training_share` of its samples, and the part that was held out.
std::vector<FlightFit> Refit::before_and_after(const Residuals& residuals, double training_share) const {
  const FlightSamples& samples = residuals.samples();
  const std::vector<double> before = residuals.values(start_.data());
  const std::vector<double> after = residuals.values(values_.data());
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (residuals.mask()[i] == Mask::none) used.push_back(i);
  }
  const auto training =
      static_cast<std::size_t>(std::llround(training_share * static_cast<double>(used.size())));
  std::vector<bool> first(after.size(), false);
  std::vector<bool> second(after.size(), false);
  std::vector<double> series(after.size(), nan);
  for (std::size_t i = 0; i < used.size(); ++i) {
    (i < training ? first : second)[used[i]] = true;
    series[used[i]] = after[used[i]];
  }
  const NoiseFloor noise =
      noise_floor(series, stretches_of(series, samples.time, samples.step), samples.step);
  std::vector<FlightFit> parts;
  const auto add = [&](const std::vector<bool>& part, bool held) {
    parts.push_back(
        {samples.name, held, statistics_of(before, noise, part), statistics_of(after, noise, part)});
  };
  if (training > 0) add(first, false);
  if (training < used.size()) add(second, true);
  return parts;
}

void Refit::compare_flights(FitFlights& flights) {
  std::vector<std::vector<FlightFit>> parts(flights.count());
  std::vector<std::vector<std::string>> notes(flights.count());
  std::vector<RegimeSet> flown(flights.count());
  flights.visit([&](std::size_t number, std::size_t, FitFlight& fit) {
    const FlightSamples& samples = fit.residuals().samples();
    parts[number] = before_and_after(fit.residuals(), options_.training_share);
    for (const std::string& note : samples.notes) notes[number].push_back(samples.name + ": " + note);
    for (const Interval& interval : samples.intervals)
      flown[number].set(static_cast<std::size_t>(interval.regime));
  });
  for (std::size_t i = 0; i < flights.count(); ++i) {
    result_.flights.insert(result_.flights.end(), parts[i].begin(), parts[i].end());
    result_.notes.insert(result_.notes.end(), notes[i].begin(), notes[i].end());
    flown_ |= flown[i];
  }
  for (const std::filesystem::path& path : options_.holdout) {
    const Flight file(path, options_.time_stamp);
    const auto samples =
        std::make_shared<const FlightSamples>(read_samples(file, model_, reference_, options_.mask));
    const std::vector<FlightFit> held =
        before_and_after(Residuals(samples, model_, reference_, options_.mask), 0.0);
    result_.flights.insert(result_.flights.end(), held.begin(), held.end());
  }
}

/// The coefficients after the fit, and their covariance.
void Refit::list_results(const Eigen::MatrixXd& errors, const std::vector<std::size_t>& fitted,
                         const std::vector<int>& stage_of, const std::vector<bool>& at_bound) {
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    FittedParameter parameter;
    parameter.name = parameters_[p].name;
    parameter.unit = parameters_[p].unit;
    parameter.start = start_[as_index(p)];
    parameter.value = values_[as_index(p)];
    parameter.standard_error = nan;
    parameter.stage = stage_of[p];
    parameter.fitted = parameter.stage > 0;
    parameter.at_bound = at_bound[p];
    const auto place = std::find(fitted.begin(), fitted.end(), p);
    if (place != fitted.end() && !parameter.at_bound) {
      const auto k = as_index(static_cast<std::size_t>(place - fitted.begin()));
      parameter.standard_error = std::sqrt(errors(k, k));
    }
    if (parameter.at_bound) {
      result_.notes.push_back(fmt::format(
          "{} is held at its bound {:.6g}: the flights want it beyond; the errors of the others hold only if "
          "that bound is true; {}",
          parameter.name, parameter.value,
          result_.condition_number > collinear_condition
              ? "the coefficients are hard to tell apart here, so rather hold one of them with --fix"
              : "if it is not meant, widen it in the model file"));
    }
    result_.parameters.push_back(std::move(parameter));
  }
  for (Eigen::Index a = 0; a < errors.rows(); ++a) {
    result_.covariance_names.push_back(parameters_[fitted[static_cast<std::size_t>(a)]].name);
    result_.covariance.emplace_back();
    for (Eigen::Index b = 0; b < errors.cols(); ++b) result_.covariance.back().push_back(errors(a, b));
  }
}

/// In words: which coefficients these flights do not determine, and what would.
void Refit::explain_errors(const Eigen::MatrixXd& covariance, const std::vector<std::size_t>& wanted) {
  const Eigen::Index size = covariance.rows();
  std::vector<std::string> grave;
  // With starting values that count as measured, a large error is no news.
  for (Eigen::Index a = 0; a < size && !uses_prior(); ++a) {
    const std::size_t parameter = wanted[static_cast<std::size_t>(a)];
    const ParameterState& state = parameters_[parameter];
    const double error = std::sqrt(covariance(a, a));
    if (!(state.typical > 0.0) || !(error > weak_share * state.typical)) continue;
    std::string partners;
    for (Eigen::Index b = 0; b < size; ++b) {
      const double correlation = covariance(a, b) / std::sqrt(covariance(a, a) * covariance(b, b));
      if (a == b || !(std::abs(correlation) > 0.9)) continue;
      partners += fmt::format("{}{} ({:+.3f})", partners.empty() ? "" : ", ",
                              parameters_[wanted[static_cast<std::size_t>(b)]].name, correlation);
    }
    grave.push_back(
        fmt::format("{} is {}: {:.3g} +- {:.2g}, where its typical size is {:.2g}{}{}; hold it with --fix "
                    "{}; what would tell: {}",
                    state.name, error > state.typical ? "not determined" : "weakly determined",
                    values_[as_index(parameter)], error, state.typical,
                    partners.empty() ? "" : ", and it goes with ", partners, state.name, state.manoeuvre));
  }
  if (result_.condition_number > collinear_condition) {
    grave.push_back(
        fmt::format("the coefficients are nearly collinear (condition number {:.0f}): their sum is known "
                    "better than each; do not read meaning into one alone",
                    result_.condition_number));
  }
  const bool knows_regimes = flown_.any();
  const bool has_manoeuvre = flown_[static_cast<std::size_t>(Regime::pitch_manoeuvre)] ||
                             flown_[static_cast<std::size_t>(Regime::yaw_manoeuvre)] ||
                             flown_[static_cast<std::size_t>(Regime::speed_run)];
  if (knows_regimes && !has_manoeuvre) {
    grave.emplace_back(
        "the flights have no pitch manoeuvre, yaw manoeuvre or speed run: the coefficients rest on climbs "
        "and slow changes, in which angle of attack, Mach number and weight go together, and may carry "
        "effects that the model does not have");
  }
  result_.notes.insert(result_.notes.begin(), grave.begin(), grave.end());
}

void Refit::write_models(const Eigen::MatrixXd& covariance, const std::vector<std::size_t>& fitted) {
  const auto place_of = [&](std::size_t parameter) {
    return static_cast<std::size_t>(std::find(fitted.begin(), fitted.end(), parameter) - fitted.begin());
  };
  const auto name_in_file = [&](std::size_t parameter) {
    std::string name = parameters_[parameter].name;
    if (name.rfind("reference:", 0) == 0) name.erase(0, std::string("reference:").size());
    return name;
  };
  const auto write = [&](ModelFile& file, std::size_t first) {
    std::size_t p = first;
    std::vector<std::size_t> inside;
    std::vector<std::string> held;
    for (std::size_t e = 0; e < file.model.effects.size(); ++e) {
      ModelEffect& effect = file.model.effects[e];
      if (file.fits.size() <= e) file.fits.resize(e + 1);
      file.fits[e].resize(effect.parameters.size());
      for (std::size_t i = 0; i < effect.parameters.size(); ++i, ++p) {
        effect.parameters[i] = values_[as_index(p)];
        ParameterFit& fit = file.fits[e][i];
        const std::size_t place = place_of(p);
        if (place == fitted.size()) {
          held.push_back(name_in_file(p));
          continue;
        }
        fit.standard_error.reset();
        const double error = result_.parameters[p].standard_error;
        if (!std::isfinite(error)) continue;
        fit.standard_error = error;
        inside.push_back(place);
      }
    }
    const Covariance before = std::exchange(file.covariance, {});
    for (const std::size_t a : inside) {
      file.covariance.parameters.push_back(name_in_file(fitted[a]));
      std::vector<double> row;
      for (const std::size_t b : inside) row.push_back(covariance(as_index(a), as_index(b)));
      file.covariance.matrix.push_back(std::move(row));
    }
    // What was known of the parameters that were held stays, and nothing ties it to those that were fitted.
    add_independent(file.covariance, part_of(before, [&held](const std::string& name) {
                      return std::find(held.begin(), held.end(), name) != held.end();
                    }));
    Provenance provenance;
    provenance.emplace_back("program", ProvenanceValue{std::string("pcor " PCOR_VERSION)});
    provenance.emplace_back(
        "date", ProvenanceValue{utc_text(static_cast<double>(std::time(nullptr)), "%Y-%m-%dT%H:%M:%SZ")});
    provenance.emplace_back("reference", ProvenanceValue{result_.reference_text});
    provenance.emplace_back("loss", ProvenanceValue{std::string(name_of(options_.loss))});
    ProvenanceList flights;
    for (const FlightFit& flight : result_.flights) {
      if (!flight.holdout) flights.emplace_back(ProvenanceValue{flight.flight});
    }
    provenance.emplace_back("flights", ProvenanceValue{std::move(flights)});
    provenance.emplace_back("samples", ProvenanceValue{static_cast<std::int64_t>(result_.samples)});
    Provenance masks;
    for (std::size_t m = 1; m < mask_count; ++m) {
      if (result_.masks[m] > 0)
        masks.emplace_back(std::string(mask_facts[m].name),
                           ProvenanceValue{static_cast<std::int64_t>(result_.masks[m])});
    }
    provenance.emplace_back("samples_not_used", ProvenanceValue{std::move(masks)});
    provenance.emplace_back("rms_hpa", ProvenanceValue{result_.rms});
    provenance.emplace_back("r2", ProvenanceValue{result_.r_squared});
    // How the temperature was calibrated stays: the pressures do not change it.
    for (auto& entry : file.provenance) {
      if (entry.first == "temperature") provenance.push_back(std::move(entry));
    }
    file.provenance = std::move(provenance);
    LawFacts law;
    law.source = fmt::format("refit by pcor to {}{}", result_.reference_text,
                             file.law.source.empty() ? "" : "; before: " + file.law.source);
    law.rms_hpa = result_.rms;
    file.law = std::move(law);
  };
  result_.model = model_;
  write(result_.model, 0);
  if (options_.fit_reference) {
    result_.reference = *reference_.system;
    write(*result_.reference, own_parameters_);
  }
}

RefitResult Refit::run() {
  if (sources_.empty()) throw Error("no flight to fit; give at least one");
  if (options_.fit_reference && reference_.kind != Reference::Kind::static_system) {
    throw Error(
        "only a static system can be fitted together with the model; give --reference static:OTHER.toml");
  }
  if (!(options_.training_share > 0.0 && options_.training_share <= 1.0)) {
    throw Error("the share of samples that is fitted has to be above 0 and at most 1");
  }
  require_one_kind();
  list_parameters();
  for (const ParameterState& state : parameters_) {
    if (!(state.bounds.lower < state.bounds.upper)) {
      throw Error(fmt::format("{}: its bounds [{}, {}] leave nothing; give them in order", state.name,
                              state.bounds.lower, state.bounds.upper));
    }
  }
  const std::vector<std::vector<std::size_t>> stage_parameters = stages();
  result_.reference_text = reference_.description();

  std::vector<std::size_t> fitted;
  std::vector<int> stage_of(parameters_.size(), 0);
  std::vector<bool> at_bound(parameters_.size(), false);
  Eigen::MatrixXd earlier(0, 0);
  Solution solution;
  std::unique_ptr<FitFlights> all;
  for (std::size_t s = 0; s < stage_parameters.size(); ++s) {
    const std::vector<std::size_t>& wanted = stage_parameters[s];
    const bool last = s + 1 == stage_parameters.size();
    if (last && wanted.empty()) break;
    FitSetup setup = setup_for(wanted);
    if (!last) {
      setup.regimes = options_.stages[s].regimes;
      setup.with_offsets = true;
    }
    all = std::make_unique<FitFlights>(sources_, std::move(setup));
    if (start_.size() == 0) start_ = values_ = all->start();
    solution = solve(*all);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      fitted.push_back(wanted[k]);
      stage_of[wanted[k]] = static_cast<int>(s) + 1;
      at_bound[wanted[k]] = solution.at_bound[k];
    }
    if (last) break;
    require_rank(all->reduce(values_, solution.offsets, nullptr), wanted);
    const Eigen::MatrixXd own = covariance(*all, solution, Eigen::MatrixXd(0, 0));
    const Eigen::Index before = earlier.rows();
    earlier.conservativeResizeLike(Eigen::MatrixXd::Zero(before + own.rows(), before + own.rows()));
    earlier.bottomRightCorner(own.rows(), own.rows()) = own;
  }
  // Everything that was fitted, over all samples: errors, what can be told apart, and what each effect does.
  if (stage_parameters.size() > 1) all = std::make_unique<FitFlights>(sources_, setup_for(fitted));
  FitFlights& flights = *all;
  flights.measure_noise(values_, Eigen::VectorXd());
  if (stage_parameters.back().empty()) solution = {};
  solution.deviation = flights.deviation(values_, Eigen::VectorXd());
  solution.offsets = Eigen::VectorXd();
  result_.masks = flights.masks();
  require_rank(flights.reduce(values_, Eigen::VectorXd(), nullptr), fitted);
  const Eigen::MatrixXd errors = covariance(flights, solution, earlier);

  const FitSums sums = sums_at(flights, values_, solution.deviation);
  result_.samples = sums.samples;
  result_.rms = sums.rms();
  result_.rms_over_pressure = std::sqrt(sums.relative_squares / static_cast<double>(sums.samples));
  result_.r_squared = sums.r_squared();
  result_.outliers = sums.outliers;
  find_omissions(flights, solution, sums);
  compare_flights(flights);
  double noise = 0.0;
  for (const FlightFit& flight : result_.flights) {
    if (!flight.holdout)
      noise += flight.after.noise_rms * flight.after.noise_rms * static_cast<double>(flight.after.samples);
  }
  result_.noise_rms = std::sqrt(noise / static_cast<double>(result_.samples));
  result_.bulk_rms = sums.bulk_rms();

  list_results(errors, fitted, stage_of, at_bound);
  explain_errors(errors, fitted);
  if (result_.rms > 1.02 * result_.rms_before) {
    result_.notes.insert(
        result_.notes.begin(),
        fmt::format("the fit left a larger rms, {:.3f} hPa, than the coefficients of the file, {:.3f}: "
                    "what a stage held does not suit the rest, or outliers rule the rms",
                    result_.rms, result_.rms_before));
  }
  if (uses_prior()) {
    result_.notes.push_back(
        "every coefficient of an effect of the catalogue was drawn to its starting value by the typical size "
        "of its effect; two static systems alone tell only their difference, so how it is shared between "
        "them is what the starting values say");
  }
  write_models(errors, fitted);
  return std::move(result_);
}

}  // namespace

std::string_view name_of(Loss loss) {
  switch (loss) {
    case Loss::tukey:
      return "tukey";
    case Loss::huber:
      return "huber";
    case Loss::soft_l1:
      return "soft-l1";
    case Loss::cauchy:
      return "cauchy";
    case Loss::none:
      return "none";
  }
  return "none";
}

std::optional<Loss> loss_named(std::string_view name) {
  for (const Loss loss : {Loss::tukey, Loss::huber, Loss::soft_l1, Loss::cauchy, Loss::none}) {
    if (name_of(loss) == name) return loss;
  }
  return std::nullopt;
}

RefitResult refit(const std::vector<std::filesystem::path>& flights, const ModelFile& model,
                  const Reference& reference, const RefitOptions& options) {
  std::vector<FlightSource> sources;
  for (const std::filesystem::path& path : flights) sources.push_back({path, nullptr});
  return Refit(std::move(sources), model, reference, options).run();
}

RefitResult refit(const std::vector<std::shared_ptr<const FlightSamples>>& flights, const ModelFile& model,
                  const Reference& reference, const RefitOptions& options) {
  std::vector<FlightSource> sources;
  for (const std::shared_ptr<const FlightSamples>& samples : flights) sources.push_back({{}, samples});
  return Refit(std::move(sources), model, reference, options).run();
}

}  // namespace pcor
