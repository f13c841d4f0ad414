#include "fit/fit_flights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <future>
#include <thread>

#include "numerics/missing.hpp"
#include "residuals/moving_columns.hpp"

namespace pcor::internal {
namespace {

/// Of a flight that is kept; of two static systems its samples are kept twice.
std::size_t bytes_of(const FlightSamples& samples, const Reference& reference) {
  const ModelSamples& model = samples.model;
  const std::size_t columns =
      model.columns.size() + model.moving.size() + samples.reference.columns.size() + 12;
  const std::size_t copies = reference.model() != nullptr ? 2 : 1;
  return copies * (columns * samples.time.size() + model.along_beam.values.size()) * sizeof(double);
}

}  // namespace

FitFlights::FitFlights(std::vector<FlightSource> sources, const FitTask& task, FitSetup setup)
    : sources_(std::move(sources)), task_(task), setup_(std::move(setup)), cache_(sources_.size()) {
  std::vector<std::size_t> kept(sources_.size());
  std::vector<std::array<std::size_t, mask_count>> masks(sources_.size());
  std::vector<std::vector<bool>> linear(sources_.size());
  std::vector<std::size_t> offsets(sources_.size());
  std::vector<std::size_t> bins(sources_.size());
  visit([&](std::size_t number, FitFlight& fit) {
    kept[number] = fit.kept().size();
    masks[number] = fit.residuals().mask_counts();
    offsets[number] = fit.offsets();
    bins[number] = fit.bins().size();
    linear[number] = fit.residuals().is_linear();
  });
  linear_ = linear.front();
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    samples_ += kept[i];
    bins_ += bins[i];
    offsets_ += offsets[i];
    for (std::size_t m = 0; m < mask_count; ++m) masks_[m] += masks[i][m];
  }
  if (!setup_.regimes.empty()) return;
  for (const FitTask& with : task_.further) {
    further_.push_back(std::make_unique<FitFlights>(sources_, with, setup_));
    if (further_.back()->sees_parameters()) seeing_.push_back(further_.back().get());
  }
}

/// Whether any derivative is not zero, and the bins are enough to find the noise.
bool FitFlights::sees_parameters() {
  constexpr std::size_t fewest_bins = 100;
  if (bins_ < fewest_bins) return false;
  std::vector<double> largest(count(), 0.0);
  visit([&](std::size_t number, FitFlight& fit) {
    const Eigen::MatrixXd rows = fit.rows(setup_.values);
    if (rows.rows() > 0)
      largest[number] = rows.leftCols(as_index(setup_.wanted.size())).cwiseAbs().maxCoeff();
  });
  return std::any_of(largest.begin(), largest.end(), [](double each) { return each > 0.0; });
}

std::vector<FitFlights*> FitFlights::joint() {
  std::vector<FitFlights*> all{this};
  all.insert(all.end(), seeing_.begin(), seeing_.end());
  return all;
}

bool FitFlights::stays_as_prepared() const {
  return has_moving_columns() || task_.reference.model() != nullptr ||
         !task_.reference.is_static_pressure() || !seeing_.empty();
}

bool FitFlights::has_moving_columns() const {
  const std::vector<ModelEffect>& effects = task_.model.model.effects;
  return std::any_of(effects.begin(), effects.end(),
                     [](const ModelEffect& effect) { return memory_of(effect).of != Quantity::count; });
}

std::shared_ptr<const FlightSamples> FitFlights::samples_of(std::size_t number) const {
  if (cache_[number]) return nullptr;
  if (sources_[number].samples) return sources_[number].samples;
  const Flight file(sources_[number].path, task_.options.time_stamp);
  return std::make_shared<const FlightSamples>(
      read_samples(file, task_.model, task_.reference, task_.options.mask));
}

std::shared_ptr<FitFlight> FitFlights::made(std::size_t number,
                                            std::shared_ptr<const FlightSamples> samples) {
  if (cache_[number]) return cache_[number];
  const bool is_given = sources_[number].samples != nullptr && samples->model.moving.empty();
  const std::size_t own_bytes = is_given ? 0 : bytes_of(*samples, task_.reference);
  auto fit = std::make_shared<FitFlight>(std::move(samples), task_, setup_);
  fit->prepare(prepared_parameters_.size() > 0 ? prepared_parameters_ : setup_.values);
  if (noise_) fit->set_noise(*noise_, number);
  const std::size_t columns = 2 * (setup_.wanted.size() + 1) + fit->offsets();
  const std::size_t bytes = own_bytes + (columns * fit->bins().size() + fit->kept().size()) * sizeof(double);
  const std::lock_guard lock(counting_);
  if (cached_bytes_ + bytes <= task_.options.memory) {
    cached_bytes_ += bytes;
    cache_[number] = fit;
  }
  return fit;
}

void FitFlights::visit_those(const std::function<bool(std::size_t)>& chosen,
                             const std::function<void(std::size_t, FitFlight&)>& visit) {
  const std::size_t wanted = task_.options.threads;
  const std::size_t threads =
      std::min<std::size_t>(wanted > 0 ? wanted : std::max(1U, std::thread::hardware_concurrency()), count());
  const auto work_on = [&](std::size_t number, std::shared_ptr<const FlightSamples> samples) {
    visit(number, *made(number, std::move(samples)));
  };
  std::deque<std::future<void>> working;
  try {
    for (std::size_t number = 0; number < count(); ++number) {
      if (!chosen(number)) continue;
      std::shared_ptr<const FlightSamples> samples = samples_of(number);
      if (threads <= 1) {
        work_on(number, std::move(samples));
        continue;
      }
      if (working.size() == threads) {
        working.front().get();
        working.pop_front();
      }
      working.push_back(std::async(std::launch::async, work_on, number, std::move(samples)));
    }
    for (std::future<void>& each : working) each.get();
  } catch (...) {
    for (std::future<void>& each : working) {
      if (each.valid()) each.wait();
    }
    throw;
  }
}

Reduction FitFlights::reduce(const Eigen::VectorXd& parameters, const ScaledLoss& loss) {
  const Eigen::Index fitted = as_index(setup_.wanted.size());
  std::vector<Reduction> parts(count());
  visit([&](std::size_t number, FitFlight& fit) {
    Reduction& part = parts[number];
    const Eigen::MatrixXd rows = fit.white_rows(parameters, loss);
    Eigen::VectorXd weight(rows.rows());
    double curvatures = 0.0;
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      const double innovation = rows(i, fitted);
      const auto [value, slope, bend] = loss(innovation);
      part.cost += 0.5 * value;
      curvatures += slope + 2.0 * innovation * innovation * bend;
      weight[i] = slope;
    }
    part.bins = fit.bins().size();
    if (weight.sum() > 0.0) part.curvature = curvatures / weight.sum();
    part.squares = rows.leftCols(fitted).array().square().matrix().transpose() * weight;
    const Eigen::MatrixXd left = fit.without_offsets(rows, weight);
    const Eigen::VectorXd scale = weight.cwiseSqrt();
    std::vector<const double*> columns;
    for (Eigen::Index k = 0; k <= fitted; ++k) columns.push_back(left.col(k).data());
    TriangularFactor factor(fitted + 1);
    factor.add(columns, scale.data(), part.bins);
    part.factor = factor.factor();
  });
  Reduction whole;
  whole.squares = Eigen::VectorXd::Zero(fitted);
  double curvature = 0.0;
  TriangularFactor sum(fitted + 1);
  for (const Reduction& part : parts) {
    sum.add(part.factor);
    whole.squares += part.squares;
    whole.cost += part.cost;
    whole.bins += part.bins;
    if (part.bins > 0) curvature += part.curvature * static_cast<double>(part.bins);
  }
  for (FitFlights* const other : seeing_) {
    const Reduction more = other->reduce(parameters, loss);
    sum.add(more.factor);
    whole.squares += more.squares;
    whole.cost += more.cost;
    whole.bins += more.bins;
    curvature += more.curvature * static_cast<double>(more.bins);
  }
  whole.curvature = curvature / static_cast<double>(whole.bins);
  whole.factor = sum.factor();
  whole.valid = std::isfinite(whole.cost) && whole.factor.allFinite();
  return whole;
}

Eigen::MatrixXd FitFlights::unweighted_factor(const Eigen::VectorXd& parameters) {
  std::vector<Eigen::MatrixXd> parts(count());
  visit([&](std::size_t number, FitFlight& fit) { parts[number] = fit.unweighted_factor(parameters); });
  TriangularFactor sum(as_index(setup_.wanted.size()) + 1);
  for (const Eigen::MatrixXd& part : parts) sum.add(part);
  return sum.factor();
}

void FitFlights::prepare(const Eigen::VectorXd& parameters) {
  // Flights that are read again are prepared again, at the same parameters.
  prepared_parameters_ = parameters;
  for (FitFlights* const other : seeing_) other->prepare(parameters);
  const auto is_kept = [this](std::size_t number) { return cache_[number] != nullptr; };
  visit_those(is_kept, [&](std::size_t number, FitFlight& fit) {
    fit.prepare(parameters);
    if (noise_) fit.set_noise(*noise_, number);
  });
}

void FitFlights::measure_noise(const Eigen::VectorXd& parameters, bool drift) {
  for (FitFlights* const other : seeing_) other->measure_noise(parameters, drift);
  if (!shares_noise_) noise_.reset();  // what is found anew need not be applied before
  prepare(parameters);
  if (shares_noise_) return;
  constexpr std::size_t enough = 16;
  const std::size_t every = (count() + enough - 1) / enough;
  const std::size_t some = (count() + every - 1) / every;
  std::vector<Binning> bins(some);
  std::vector<Eigen::VectorXd> residuals(some);
  std::vector<Eigen::MatrixXd> columns(some);
  const auto is_one = [every](std::size_t number) { return number % every == 0; };
  visit_those(is_one, [&](std::size_t number, FitFlight& fit) {
    const Eigen::MatrixXd rows = fit.rows(parameters);
    bins[number / every] = fit.bins();
    residuals[number / every] = rows.rightCols(1);
    columns[number / every] = rows.leftCols(as_index(setup_.wanted.size()));
  });
  const auto found = std::make_shared<FitNoise>();
  found->shared = drift ? find_noise(bins, columns, residuals, task_.options.threads).model
                        : estimate_noise(bins, residuals);
  found->shared.level.clear();
  found->levels.resize(count());
  visit([&](std::size_t number, FitFlight& fit) {
    found->levels[number] = noise_levels(fit.bins(), fit.rows(parameters).rightCols(1), found->shared);
    if (cache_[number]) fit.set_noise(*found, number);
  });
  noise_ = found;
}

double FitFlights::drift_rms() const {
  double squares = 0.0;
  for (std::size_t k = 0; noise_ && k < slow_times.size(); ++k)
    squares += noise_->shared.slow[k] * noise_->shared.slow[k];
  return std::sqrt(squares);
}

std::vector<double> FitFlights::innovations(const Eigen::VectorXd& parameters) {
  std::vector<std::vector<double>> parts(count());
  visit([&](std::size_t number, FitFlight& fit) {
    const Eigen::VectorXd innovations = fit.white_rows(parameters, {}).rightCols(1);
    parts[number].assign(innovations.data(), innovations.data() + innovations.size());
  });
  std::vector<double> all;
  for (const std::vector<double>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

double FitFlights::deviation(const Eigen::VectorXd& parameters) {
  std::vector<double> all;
  for (FitFlights* const each : joint()) {
    const std::vector<double> more = each->innovations(parameters);
    all.insert(all.end(), more.begin(), more.end());
  }
  return robust_deviation(std::move(all));
}

}  // namespace pcor::internal
