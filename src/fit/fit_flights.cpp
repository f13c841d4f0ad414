#include "fit/fit_flights.hpp"

#include <ceres/loss_function.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <future>
#include <thread>

#include <pcor/words/error.hpp>
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

std::size_t bytes_of(const FlightSamples& samples) {
  const std::size_t columns = samples.model.columns.size() + samples.reference.columns.size() + 12;
  return columns * samples.time.size() * sizeof(double);
}

}  // namespace

FitFlight::FitFlight(std::shared_ptr<const FlightSamples> samples, const FitTask& task, const FitSetup& setup)
    : task_(&task),
      setup_(&setup),
      residuals_(std::move(samples), task.model, task.reference, task.options.mask),
      static_pressure_(residuals_.samples().model.find(Quantity::static_pressure)) {
  const FlightSamples& flight = residuals_.samples();
  const std::vector<Mask>& mask = residuals_.mask();
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i] == Mask::none) kept_.push_back(i);
  }
  const auto training =
      static_cast<std::size_t>(std::llround(task.options.training_share * static_cast<double>(kept_.size())));
  kept_.resize(training);
  if (!setup.regimes.empty()) {
    std::vector<std::size_t> inside;
    for (const Interval& interval : flight.intervals) {
      if (std::find(setup.regimes.begin(), setup.regimes.end(), interval.regime) == setup.regimes.end())
        continue;
      const std::size_t before = inside.size();
      for (const std::size_t i : kept_) {
        if (flight.time[i] >= interval.begin && flight.time[i] < interval.end) inside.push_back(i);
      }
      if (inside.size() == before) continue;
      if (setup.with_offsets) offset_.resize(inside.size(), static_cast<int>(offset_count_));
      ++offset_count_;
    }
    if (!setup.with_offsets) offset_count_ = 0;
    kept_ = std::move(inside);
  }
  linear_ = std::all_of(setup.wanted.begin(), setup.wanted.end(),
                        [this](std::size_t parameter) { return residuals_.is_linear()[parameter]; });
}

void FitFlight::keep_derivatives() {
  if (!linear_) return;
  kept_parameters_ = setup_->values;
  const std::size_t count = kept_.size();
  std::vector<double> residual(count);
  std::vector<double> derivatives(setup_->wanted.size() * count);
  std::vector<double> part(setup_->wanted.size() * samples_per_chunk);
  for (std::size_t first = 0; first < count; first += samples_per_chunk) {
    const std::size_t length = std::min(samples_per_chunk, count - first);
    residuals_.evaluate(kept_.data() + first, length, kept_parameters_.data(), setup_->wanted,
                        residual.data() + first, part.data());
    for (std::size_t k = 0; k < setup_->wanted.size(); ++k)
      std::copy_n(part.data() + k * length, length, derivatives.data() + k * count + first);
  }
  kept_residual_ = std::move(residual);
  kept_derivatives_ = std::move(derivatives);
}

void FitFlight::evaluate_now(std::size_t first, std::size_t count, const Eigen::VectorXd& parameters,
                             const std::vector<std::size_t>& wanted, double* residual,
                             double* derivatives) const {
  const std::size_t* const samples = kept_.data() + first;
  if (linear_) {
    residuals_.evaluate(samples, count, parameters.data(), wanted, residual, derivatives);
  } else {
    residuals_.evaluate_at_sensor(samples, count, parameters.data(), wanted, residual, derivatives);
  }
}

/// From the derivatives that are kept, where there are any.
void FitFlight::find_residuals(std::size_t first, std::size_t count, const Eigen::VectorXd& parameters,
                               const double* offsets, double* residual) const {
  if (kept_residual_.empty()) {
    evaluate_now(first, count, parameters, {}, residual, nullptr);
  } else {
    std::copy_n(kept_residual_.data() + first, count, residual);
    for (std::size_t k = 0; k < setup_->wanted.size(); ++k) {
      const Eigen::Index parameter = as_index(setup_->wanted[k]);
      const double step = parameters[parameter] - kept_parameters_[parameter];
      const double* const column = kept_derivatives_.data() + k * kept_.size() + first;
      for (std::size_t i = 0; i < count; ++i) residual[i] += step * column[i];
    }
  }
  if (offset_.empty()) return;
  for (std::size_t i = 0; i < count; ++i)
    residual[i] -= offsets[offset_[first + i]] * static_pressure(first + i);
}

std::vector<double> FitFlight::values(const Eigen::VectorXd& parameters, const double* offsets) const {
  std::vector<double> result(kept_.size());
  for (std::size_t first = 0; first < kept_.size(); first += samples_per_chunk) {
    find_residuals(first, std::min(samples_per_chunk, kept_.size() - first), parameters, offsets,
                   result.data() + first);
  }
  return result;
}

void FitFlight::evaluate(std::size_t first, std::size_t count, const Eigen::VectorXd& parameters,
                         const Eigen::VectorXd& offsets, std::size_t first_offset, Rows& rows) const {
  const std::size_t fitted = setup_->wanted.size();
  const auto all_offsets = static_cast<std::size_t>(offsets.size());
  const bool kept = !kept_residual_.empty();
  rows.columns.clear();
  rows.store.assign((all_offsets + 1 + (kept ? 0 : fitted)) * count, 0.0);
  double* const residual = rows.store.data();
  double* const shifts = residual + count;
  double* const derivatives = shifts + all_offsets * count;
  if (kept) {
    find_residuals(first, count, parameters, offsets.data() + first_offset, residual);
  } else {
    evaluate_now(first, count, parameters, setup_->wanted, residual, derivatives);
    for (std::size_t i = 0; i < count && !offset_.empty(); ++i) {
      const Eigen::Index offset = as_index(first_offset) + offset_[first + i];
      residual[i] -= offsets[offset] * static_pressure(first + i);
    }
  }
  for (std::size_t k = 0; k < fitted; ++k)
    rows.columns.push_back(kept ? kept_derivatives_.data() + k * kept_.size() + first
                                : derivatives + k * count);
  for (std::size_t k = 0; k < all_offsets; ++k) rows.columns.push_back(shifts + k * count);
  for (std::size_t i = 0; i < count && !offset_.empty(); ++i) {
    const std::size_t offset = first_offset + static_cast<std::size_t>(offset_[first + i]);
    shifts[offset * count + i] = -static_pressure(first + i);
  }
  rows.columns.push_back(residual);
}

void FitFlight::measure_noise(const Eigen::VectorXd& parameters, const double* offsets) {
  const FlightSamples& flight = residuals_.samples();
  const std::vector<double> residual = values(parameters, offsets);
  std::vector<double> series(flight.time.size(), nan);
  for (std::size_t i = 0; i < kept_.size(); ++i) series[kept_[i]] = residual[i];
  const NoiseFloor floor = noise_floor(series, stretches_of(series, flight.time, flight.step), flight.step);
  noise_.assign(kept_.size(), 1.0F);
  // Without noise (data that a formula made) all samples count alike.
  if (!(floor.rms > 0.0)) return;
  for (std::size_t i = 0; i < kept_.size(); ++i) noise_[i] = static_cast<float>(floor.local_rms[kept_[i]]);
}

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
  visit([&](std::size_t number, std::size_t, FitFlight& fit) {
    kept[number] = fit.kept().size();
    masks[number] = fit.residuals().mask_counts();
    offsets[number] = fit.offsets();
    linear[number] = fit.residuals().is_linear();
  });
  linear_ = linear.front();
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    samples_ += kept[i];
    first_offset_[i] = offsets_;
    offsets_ += offsets[i];
    for (std::size_t m = 0; m < mask_count; ++m) masks_[m] += masks[i][m];
  }
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
  const std::size_t own_bytes = sources_[number].samples ? 0 : bytes_of(*samples);
  auto fit = std::make_shared<FitFlight>(std::move(samples), task_, setup_);
  if (noise_parameters_.size() > 0)
    fit->measure_noise(noise_parameters_, noise_offsets_.data() + first_offset_[number]);
  const std::size_t bytes = own_bytes + fit->kept().size() * (setup_.wanted.size() + 1) * sizeof(double);
  fit->keep_derivatives();
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
  const Eigen::Index columns = as_index(setup_.wanted.size() + offsets_ + 1);
  std::vector<Reduction> parts(count());
  visit([&](std::size_t number, std::size_t first_offset, FitFlight& fit) {
    Reduction& part = parts[number];
    TriangularFactor factor(columns);
    FitFlight::Rows rows;
    std::array<double, samples_per_chunk> scale{};
    double slopes = 0.0;
    double curvatures = 0.0;
    for (std::size_t first = 0; first < fit.kept().size(); first += samples_per_chunk) {
      const std::size_t length = std::min(samples_per_chunk, fit.kept().size() - first);
      fit.evaluate(first, length, parameters, offsets, first_offset, rows);
      for (std::size_t i = 0; i < length; ++i) {
        const double noise = fit.noise(first + i);
        const double normal = rows.residual()[i] / noise;
        std::array<double, 3> rho{normal * normal, 1.0, 0.0};
        if (loss != nullptr) loss->Evaluate(rho[0], rho.data());
        part.cost += 0.5 * rho[0];
        slopes += rho[1];
        curvatures += rho[1] + 2.0 * normal * normal * rho[2];
        scale[i] = std::sqrt(rho[1]) / noise;
      }
      factor.add(rows.columns, scale.data(), length);
    }
    part.samples = fit.kept().size();
    if (slopes > 0.0) part.curvature = curvatures / slopes;
    part.factor = factor.factor();
  });
  Reduction whole;
  double curvature = 0.0;
  TriangularFactor sum(columns);
  for (const Reduction& part : parts) {
    sum.add(part.factor);
    whole.cost += part.cost;
    whole.samples += part.samples;
    if (part.samples > 0) curvature += part.curvature * static_cast<double>(part.samples);
  }
  whole.curvature = curvature / static_cast<double>(whole.samples);
  whole.factor = sum.factor();
  whole.valid = std::isfinite(whole.cost) && whole.factor.allFinite();
  return whole;
}

Eigen::MatrixXd FitFlights::unweighted_factor(const Eigen::VectorXd& parameters) {
  const Eigen::Index columns = as_index(setup_.wanted.size() + 1);
  const std::vector<double> ones(samples_per_chunk, 1.0);
  std::vector<Eigen::MatrixXd> parts(count());
  visit([&](std::size_t number, std::size_t, FitFlight& fit) {
    TriangularFactor factor(columns);
    FitFlight::Rows rows;
    for (std::size_t first = 0; first < fit.kept().size(); first += samples_per_chunk) {
      const std::size_t length = std::min(samples_per_chunk, fit.kept().size() - first);
      fit.evaluate(first, length, parameters, Eigen::VectorXd(), 0, rows);
      factor.add(rows.columns, ones.data(), length);
    }
    parts[number] = factor.factor();
  });
  TriangularFactor sum(columns);
  for (const Eigen::MatrixXd& part : parts) sum.add(part);
  return sum.factor();
}

void FitFlights::measure_noise(const Eigen::VectorXd& parameters, const Eigen::VectorXd& offsets) {
  // Flights that are read again measure it again, at the same parameters.
  noise_parameters_ = parameters;
  noise_offsets_ = offsets;
  visit([&](std::size_t number, std::size_t first_offset, FitFlight& fit) {
    if (cache_[number]) fit.measure_noise(parameters, offsets.data() + first_offset);
  });
}

double FitFlights::deviation(const Eigen::VectorXd& parameters, const Eigen::VectorXd& offsets) {
  std::vector<double> squares(count(), 0.0);
  visit([&](std::size_t number, std::size_t first_offset, FitFlight& fit) {
    std::vector<double> normal = fit.values(parameters, offsets.data() + first_offset);
    for (std::size_t i = 0; i < normal.size(); ++i) normal[i] /= fit.noise(i);
    if (normal.empty()) return;
    const auto samples = static_cast<double>(normal.size());
    const double deviation = robust_deviation(std::move(normal));
    squares[number] = samples * deviation * deviation;
  });
  double sum = 0.0;
  for (const double square : squares) sum += square;
  return std::sqrt(sum / static_cast<double>(samples_));
}

}  // namespace pcor::internal
