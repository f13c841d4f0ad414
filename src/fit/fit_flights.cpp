#include "fit/fit_flights.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "campaign/gps_rows.hpp"
#include "numerics/binned_rows.hpp"
#include "numerics/median.hpp"
#include "numerics/missing.hpp"
#include "numerics/noise_flights.hpp"
#include "parallel/digest.hpp"
#include "parallel/distributed_median.hpp"
#include "residuals/moving_columns.hpp"

namespace pcor::internal {
namespace {

/// Values of a flight in addition to the samples of the set: copies of them at common pressures, or with
/// columns that depend on coefficients.
std::size_t samples_kept_by_a_fit(const FlightSamples& samples, const Reference& reference) {
  const ModelSamples& model = samples.model;
  const std::size_t columns =
      model.columns.size() + model.moving.size() + samples.reference.columns.size() + 12;
  const std::size_t copies = (reference.model() != nullptr ? 1 : 0) + (model.moving.empty() ? 0 : 1);
  return copies * (columns * samples.time.size() + model.along_beam.values.size());
}

struct FlightCounts {
  std::size_t samples = 0;
  std::size_t bins = 0;
  std::size_t offsets = 0;
  std::array<std::size_t, mask_count> masks{};
  std::vector<bool> linear{};  ///< for each of the parameters whether the residual is linear in it
  double begin = 0.0;          ///< of the first bin, s since 1970 UTC

  template <class Archive>
  void serialize(Archive& archive) {
    archive(samples, bins, offsets, masks, linear, begin);
  }
};

}  // namespace

Eigen::VectorXd Reduction::lengths() const {
  Eigen::VectorXd squares = factor.leftCols(factor.cols() - 1).colwise().squaredNorm();
  if (absorbed.size() > 0) squares += absorbed;
  return squares.cwiseSqrt();
}

std::uint64_t digest_of(const Eigen::VectorXd& parameters) {
  const auto* const bytes = reinterpret_cast<const char*>(parameters.data());
  return digest_of(std::string_view(bytes, static_cast<std::size_t>(parameters.size()) * sizeof(double)));
}

FitFlights::FitFlights(const FitTask& task, FitSetup setup)
    : task_(task),
      setup_(std::move(setup)),
      doubt_(task.model, task.reference, task.options.trust_reference),
      cache_(task.flights.size()),
      reserved_{task.flights} {
  const auto counts = of_each([](std::size_t, FitFlight& fit) {
    const std::vector<double>& time = fit.bins().time();
    return FlightCounts{fit.kept().size(),
                        fit.bins().size(),
                        fit.offsets(),
                        fit.residuals().mask_counts(),
                        fit.residuals().is_linear(),
                        time.empty() ? 0.0 : time.front()};
  });
  linear_ = counts.front().linear;
  for (const FlightCounts& flight : counts) {
    samples_ += flight.samples;
    bins_ += flight.bins;
    offsets_ += flight.offsets;
    for (std::size_t m = 0; m < mask_count; ++m) masks_[m] += flight.masks[m];
  }
  std::vector<NoiseFlight> binned;
  for (const FlightCounts& flight : counts) binned.push_back({flight.begin, flight.bins});
  for_noise_ = flights_for_noise(binned);
  if (!setup_.regimes.empty()) return;
  for (const FitTask& with : task_.further) {
    further_.push_back(std::make_unique<FitFlights>(with, setup_));
    // GPS is fitted after the others, with a separate likelihood.
    if (!gps_kind(with.reference) && further_.back()->sees_parameters())
      seeing_.push_back(further_.back().get());
  }
}

/// Whether any derivative is not zero, and the bins are enough to find the noise.
bool FitFlights::sees_parameters() {
  constexpr std::size_t min_bins = 100;
  if (bins_ < min_bins || setup_.wanted.empty()) return false;
  const auto largest = of_each([this](std::size_t, FitFlight& fit) {
    const Eigen::MatrixXd rows = fit.rows(setup_.values);
    return rows.rows() > 0 ? rows.leftCols(as_index(setup_.wanted.size())).cwiseAbs().maxCoeff() : 0.0;
  });
  return std::any_of(largest.begin(), largest.end(), [](double each) { return each > 0.0; });
}

bool FitFlights::masks_change_at(const Eigen::VectorXd& parameters) {
  bool change = false;
  for (FitFlights* const each : joint()) {
    for (const int one :
         each->of_each([&](std::size_t, FitFlight& fit) { return fit.masks_change_at(parameters) ? 1 : 0; },
                       parameters))
      change = change || one != 0;
  }
  return change;
}

std::vector<FitFlights*> FitFlights::joint() {
  std::vector<FitFlights*> all{this};
  all.insert(all.end(), seeing_.begin(), seeing_.end());
  return all;
}

bool FitFlights::uses_fixed_jacobian() const {
  return has_moving_columns() || keeps_derivatives(task_.reference) || !seeing_.empty();
}

bool FitFlights::has_moving_columns() const {
  const std::vector<ModelEffect>& effects = task_.model.model.effects;
  return std::any_of(effects.begin(), effects.end(),
                     [](const ModelEffect& effect) { return memory_of(effect).of != Quantity::count; });
}

std::shared_ptr<const FlightSamples> FitFlights::samples_of(std::size_t number) const {
  if (cache_[number]) return nullptr;
  return task_.flights.samples(number, task_.model, task_.reference, task_.options.mask);
}

std::shared_ptr<FitFlight> FitFlights::made(std::size_t number,
                                            std::shared_ptr<const FlightSamples> samples) {
  if (cache_[number]) return cache_[number];
  const std::size_t own_samples = samples_kept_by_a_fit(*samples, task_.reference);
  auto fit = std::make_shared<FitFlight>(std::move(samples), task_, setup_);
  fit->prepare(prepared_parameters_.size() > 0 ? prepared_parameters_ : setup_.values);
  if (noise_) fit->set_noise(*noise_, number);
  const std::size_t columns = 2 * (setup_.wanted.size() + 1) + fit->offsets();
  const std::size_t bytes =
      (own_samples + columns * fit->bins().size() + fit->kept().size()) * sizeof(double);
  if (task_.flights.reserve(bytes)) {
    reserved_.bytes += bytes;
    cache_[number] = fit;
  }
  return fit;
}

void FitFlights::visit_those(const std::function<bool(std::size_t)>& chosen,
                             const std::function<void(std::size_t, FitFlight&)>& visit) {
  task_.flights.share().visit(
      task_.threads(), chosen, [this](std::size_t number) { return samples_of(number); },
      [&](std::size_t number, std::shared_ptr<const FlightSamples> samples) {
        visit(number, *made(number, std::move(samples)));
      });
}

Reduction FitFlights::reduce(const Eigen::VectorXd& parameters, const ScaledLoss& loss) {
  const Eigen::Index fitted = as_index(setup_.wanted.size());
  const auto reduced = [&](std::size_t, FitFlight& fit) {
    Reduction part;
    const Eigen::MatrixXd rows = fit.white_rows(parameters, loss);
    Eigen::VectorXd weight(rows.rows());
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      const double innovation = rows(i, fitted);
      const std::array<double, 3> rho = loss(innovation);
      part.cost += 0.5 * rho[0];
      weight[i] = rho[1];
    }
    const Eigen::MatrixXd left = fit.without_offsets(rows, weight);
    if (fit.offsets() > 0) {
      const Eigen::MatrixXd taken = (rows - left).leftCols(fitted);
      part.absorbed = taken.array().square().matrix().transpose() * weight;
    }
    TriangularFactor factor(fitted + 1);
    factor.add(left, weight.cwiseSqrt());
    part.factor = factor.factor();
    return part;
  };
  Reduction whole;
  whole.absorbed = Eigen::VectorXd::Zero(fitted);
  TriangularFactor sum(fitted + 1);
  for (const Reduction& part : of_each(reduced, parameters)) {
    sum.add(part.factor);
    if (part.absorbed.size() > 0) whole.absorbed += part.absorbed;
    whole.cost += part.cost;
  }
  for (FitFlights* const other : seeing_) {
    const Reduction more = other->reduce(parameters, loss);
    sum.add(more.factor);
    whole.cost += more.cost;
  }
  whole.factor = sum.factor();
  whole.valid = std::isfinite(whole.cost) && whole.factor.allFinite();
  return whole;
}

Eigen::MatrixXd FitFlights::unweighted_factor(const Eigen::VectorXd& parameters) {
  const auto factor = [&](std::size_t, FitFlight& fit) { return fit.unweighted_factor(parameters); };
  TriangularFactor sum(as_index(setup_.wanted.size()) + 1);
  for (const Eigen::MatrixXd& part : of_each(factor, parameters)) sum.add(part);
  return sum.factor();
}

void FitFlights::prepare(const Eigen::VectorXd& parameters) {
  // Flights that are read again are prepared again, at the same parameters.
  prepared_parameters_ = parameters;
  for (FitFlights* const other : seeing_) other->prepare(parameters);
  const auto is_kept = [this](std::size_t number) { return cache_[number] != nullptr; };
  task_.flights.share().attempt([&] {
    visit_those(is_kept, [&](std::size_t number, FitFlight& fit) {
      fit.prepare(parameters);
      if (noise_) fit.set_noise(*noise_, number);
    });
  });
}

void FitFlights::measure_noise(const Eigen::VectorXd& parameters, bool slow_parts,
                               const std::function<Eigen::VectorXd(const FitFlight&)>& misfit) {
  for (FitFlights* const other : seeing_) other->measure_noise(parameters, slow_parts);
  if (!shares_noise_) noise_.reset();  // the noise is estimated again, so the old one is not applied
  prepare(parameters);
  if (shares_noise_) return;
  const auto some = task_.flights.share().gather_flights<BinnedRows>(
      [&](std::vector<BinnedRows>& parts) {
        visit_those(
            [this](std::size_t number) {
              return std::binary_search(for_noise_.begin(), for_noise_.end(), number);
            },
            [&](std::size_t number, FitFlight& fit) {
              parts[number] = {fit.bins(), fit.rows(parameters)};
              if (misfit) parts[number].rows.rightCols(1) -= misfit(fit);
            });
      },
      digest_of(parameters));
  std::vector<Binning> bins;
  std::vector<Eigen::VectorXd> residuals;
  std::vector<Eigen::MatrixXd> columns;
  for (const std::size_t number : for_noise_) {
    bins.push_back(some[number].bins);
    residuals.emplace_back(some[number].rows.rightCols(1));
    columns.emplace_back(some[number].rows.leftCols(as_index(setup_.wanted.size())));
  }
  const auto found = std::make_shared<FitNoise>();
  const bool slow = slow_parts || !task_.reference.is_of_one_sample();
  found->shared =
      slow ? find_noise(bins, columns, residuals, task_.threads()).model : estimate_noise(bins, residuals);
  found->shared.level.clear();
  found->levels.resize(count());
  std::vector<std::vector<double>> of_each(count());  // residuals in bins
  task_.flights.share().attempt([&] {
    visit([&](std::size_t number, FitFlight& fit) {
      Eigen::VectorXd residual = fit.rows(parameters).rightCols(1);
      of_each[number].assign(residual.begin(), residual.end());
      if (misfit) residual -= misfit(fit);
      found->levels[number] = noise_levels(fit.bins(), residual, found->shared);
    });
  });
  std::vector<double> own;
  for (const std::vector<double>& flight : of_each) own.insert(own.end(), flight.begin(), flight.end());
  const double deviation =
      deviation_of_median * median_of_absolute_values(task_.flights.share().comm(), std::move(own));
  if (deviation > 0.0) found->deviation = deviation;
  for (std::size_t number = 0; number < count(); ++number) {
    if (cache_[number]) cache_[number]->set_noise(*found, number);
  }
  noise_ = found;
}

double FitFlights::drift_rms() const {
  double squares = 0.0;
  for (std::size_t k = 0; noise_ && k < slow_times.size(); ++k)
    squares += noise_->shared.slow[k] * noise_->shared.slow[k];
  return std::sqrt(squares);
}

double FitFlights::deviation(const Eigen::VectorXd& parameters) {
  std::vector<double> own;
  for (FitFlights* const each : joint()) {
    std::vector<Eigen::VectorXd> innovations(count());
    task_.flights.share().attempt([&] {
      each->visit([&](std::size_t number, FitFlight& fit) {
        innovations[number] = fit.white_rows(parameters, {}).rightCols(1);
      });
    });
    for (const Eigen::VectorXd& flight : innovations)
      own.insert(own.end(), flight.data(), flight.data() + flight.size());
  }
  return deviation_of_median * median_of_absolute_values(task_.flights.share().comm(), std::move(own));
}

}  // namespace pcor::internal
