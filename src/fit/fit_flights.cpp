#include "fit/fit_flights.hpp"

#include <ceres/loss_function.h>

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
    : sources_(std::move(sources)),
      task_(task),
      setup_(std::move(setup)),
      cache_(sources_.size()),
      first_offset_(sources_.size(), 0) {
  std::vector<std::size_t> kept(sources_.size());
  std::vector<std::array<std::size_t, mask_count>> masks(sources_.size());
  std::vector<std::vector<bool>> linear(sources_.size());
  std::vector<std::size_t> offsets(sources_.size());
  std::vector<std::size_t> bins(sources_.size());
  visit([&](std::size_t number, std::size_t, FitFlight& fit) {
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
    first_offset_[i] = offsets_;
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
  visit([&](std::size_t number, std::size_t, FitFlight& fit) {
    const Eigen::MatrixXd rows = fit.rows(setup_.values, Eigen::VectorXd());
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
  if (prepared_parameters_.size() > 0) {
    fit->prepare(prepared_parameters_, own(prepared_offsets_, first_offset_[number], *fit));
  } else {
    fit->prepare(setup_.values, Eigen::VectorXd::Zero(as_index(fit->offsets())));
  }
  if (noise_) fit->set_noise(*noise_, number);
  const std::size_t bytes =
      own_bytes + (2 * fit->bins().size() * (setup_.wanted.size() + 1) + fit->kept().size()) * sizeof(double);
  const std::lock_guard lock(counting_);
  if (cached_bytes_ + bytes <= task_.options.memory) {
    cached_bytes_ += bytes;
    cache_[number] = fit;
  }
  return fit;
}

void FitFlights::visit(const std::function<void(std::size_t, std::size_t, FitFlight&)>& visit) {
  const std::size_t wanted = task_.options.threads;
  const std::size_t threads =
      std::min<std::size_t>(wanted > 0 ? wanted : std::max(1U, std::thread::hardware_concurrency()), count());
  const auto work_on = [&](std::size_t number, std::shared_ptr<const FlightSamples> samples) {
    visit(number, first_offset_[number], *made(number, std::move(samples)));
  };
  std::deque<std::future<void>> working;
  try {
    for (std::size_t number = 0; number < count(); ++number) {
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

Reduction FitFlights::reduce(const Eigen::VectorXd& parameters, const Eigen::VectorXd& offsets,
                             const ceres::LossFunction* loss) {
  const Eigen::Index fitted = as_index(setup_.wanted.size());
  const Eigen::Index columns = fitted + as_index(offsets_) + 1;
  std::vector<Reduction> parts(count());
  visit([&](std::size_t number, std::size_t first_offset, FitFlight& fit) {
    Reduction& part = parts[number];
    const Eigen::MatrixXd rows = fit.white_rows(parameters, own(offsets, first_offset, fit));
    const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(rows.rows());
    std::vector<const double*> pointers(static_cast<std::size_t>(columns), nothing.data());
    for (Eigen::Index k = 0; k < fitted; ++k) pointers[static_cast<std::size_t>(k)] = rows.col(k).data();
    for (std::size_t k = 0; k < fit.offsets() && offsets_ > 0; ++k)
      pointers[static_cast<std::size_t>(fitted) + first_offset + k] = rows.col(fitted + as_index(k)).data();
    pointers.back() = rows.col(rows.cols() - 1).data();
    std::vector<double> scale(static_cast<std::size_t>(rows.rows()));
    double slopes = 0.0;
    double curvatures = 0.0;
    for (std::size_t i = 0; i < scale.size(); ++i) {
      const double innovation = pointers.back()[i];
      std::array<double, 3> rho{innovation * innovation, 1.0, 0.0};
      if (loss != nullptr) loss->Evaluate(rho[0], rho.data());
      part.cost += 0.5 * rho[0];
      slopes += rho[1];
      curvatures += rho[1] + 2.0 * innovation * innovation * rho[2];
      scale[i] = std::sqrt(rho[1]);
    }
    TriangularFactor factor(columns);
    factor.add(pointers, scale.data(), scale.size());
    part.bins = scale.size();
    if (slopes > 0.0) part.curvature = curvatures / slopes;
    part.factor = factor.factor();
  });
  Reduction whole;
  double curvature = 0.0;
  TriangularFactor sum(columns);
  for (const Reduction& part : parts) {
    sum.add(part.factor);
    whole.cost += part.cost;
    whole.bins += part.bins;
    if (part.bins > 0) curvature += part.curvature * static_cast<double>(part.bins);
  }
  for (FitFlights* const other : seeing_) {
    const Reduction more = other->reduce(parameters, offsets, loss);
    sum.add(more.factor);
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
  visit([&](std::size_t number, std::size_t, FitFlight& fit) {
    parts[number] = fit.unweighted_factor(parameters);
  });
  TriangularFactor sum(as_index(setup_.wanted.size()) + 1);
  for (const Eigen::MatrixXd& part : parts) sum.add(part);
  return sum.factor();
}

void FitFlights::prepare(const Eigen::VectorXd& parameters, const Eigen::VectorXd& offsets) {
  // Flights that are read again are prepared again, at the same parameters.
  prepared_parameters_ = parameters;
  prepared_offsets_ = offsets;
  for (FitFlights* const other : seeing_) other->prepare(parameters, offsets);
  visit([&](std::size_t number, std::size_t first_offset, FitFlight& fit) {
    if (!cache_[number]) return;
    fit.prepare(parameters, own(offsets, first_offset, fit));
    if (noise_) fit.set_noise(*noise_, number);
  });
}

void FitFlights::measure_noise(const Eigen::VectorXd& parameters, const Eigen::VectorXd& offsets,
                               bool drift) {
  for (FitFlights* const other : seeing_) other->measure_noise(parameters, offsets, drift);
  if (!shares_noise_) noise_.reset();  // what is found anew need not be applied before
  prepare(parameters, offsets);
  if (shares_noise_) return;
  // How slow the noise is, is found from a few of many flights.
  constexpr std::size_t enough = 16;
  const std::size_t every = (count() + enough - 1) / enough;
  std::vector<Binning> bins(count());
  std::vector<Eigen::VectorXd> residuals(count());
  std::vector<Eigen::MatrixXd> columns(count());
  visit([&](std::size_t number, std::size_t first_offset, FitFlight& fit) {
    const Eigen::MatrixXd rows = fit.rows(parameters, own(offsets, first_offset, fit));
    bins[number] = fit.bins();
    residuals[number] = rows.rightCols(1);
    if (number % every == 0) columns[number] = rows.leftCols(as_index(setup_.wanted.size()));
  });
  auto found = std::make_shared<FitNoise>();
  found->model = drift ? find_noise(bins, columns, residuals, task_.options.threads).model
                       : estimate_noise(bins, residuals);
  for (const Binning& each : bins) found->time.push_back(each.time());
  noise_ = std::move(found);
  visit([&](std::size_t number, std::size_t, FitFlight& fit) {
    if (cache_[number]) fit.set_noise(*noise_, number);
  });
}

double FitFlights::drift_rms() const {
  double squares = 0.0;
  for (std::size_t k = 0; noise_ && k < slow_times.size(); ++k)
    squares += noise_->model.slow[k] * noise_->model.slow[k];
  return std::sqrt(squares);
}

std::vector<double> FitFlights::innovations(const Eigen::VectorXd& parameters,
                                            const Eigen::VectorXd& offsets) {
  std::vector<std::vector<double>> parts(count());
  visit([&](std::size_t number, std::size_t first_offset, FitFlight& fit) {
    const Eigen::VectorXd innovations =
        fit.white_rows(parameters, own(offsets, first_offset, fit)).rightCols(1);
    parts[number].assign(innovations.data(), innovations.data() + innovations.size());
  });
  std::vector<double> all;
  for (const std::vector<double>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

double FitFlights::deviation(const Eigen::VectorXd& parameters, const Eigen::VectorXd& offsets) {
  std::vector<double> all;
  for (FitFlights* const each : joint()) {
    const std::vector<double> more = each->innovations(parameters, offsets);
    all.insert(all.end(), more.begin(), more.end());
  }
  return robust_deviation(std::move(all));
}

}  // namespace pcor::internal
