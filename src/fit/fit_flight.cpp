#include "fit/fit_flights.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"
#include "numerics/spikes.hpp"
#include "residuals/masks.hpp"
#include "residuals/moving_columns.hpp"

namespace pcor::internal {

namespace {

/// How many parameters of residuals are the model's own; those of the reference's model stand behind them.
std::size_t parameters_of_model(const FitTask& task) {
  std::size_t count = task.model.model.additions.size();
  for (const ModelEffect& effect : task.model.model.effects) count += effect.parameters.size();
  return count;
}

/// Where the coefficients of an effect begin among those of a model's effects; nothing where it has none.
std::optional<std::size_t> place_of(const ModelFile& model, const std::string& effect) {
  std::size_t place = 0;
  for (const ModelEffect& each : model.model.effects) {
    if (each.id == effect) return place;
    place += each.parameters.size();
  }
  return std::nullopt;
}

/// A coefficient of an effect that the model and the reference's model have alike, and its neutral value.
struct Alike {
  std::size_t place;  ///< among the parameters of residuals
  double neutral;
};

std::vector<Alike> alike_in(const FitTask& task) {
  std::vector<Alike> alike;
  const ModelFile* const other = task.reference.model();
  if (other == nullptr) return alike;
  for (const std::string& effect : task.options.alike) {
    const std::vector<double> neutral = neutral_effect(effect).parameters;
    const auto add = [&](const ModelFile& model, std::size_t first) {
      const std::optional<std::size_t> place = place_of(model, effect);
      for (std::size_t i = 0; place && i < neutral.size(); ++i)
        alike.push_back({first + *place + i, neutral[i]});
    };
    add(task.model, 0);
    add(*other, parameters_of_model(task));
  }
  return alike;
}

}  // namespace

std::size_t shared_parameters(const Residuals& residuals, const FitTask& task) {
  return task.shares_system ? residuals.parameters().size() : parameters_of_model(task);
}

Eigen::VectorXd own_parameters(const Residuals& residuals, const FitTask& task,
                               const Eigen::VectorXd& parameters) {
  const std::vector<double>& file = residuals.parameters();
  Eigen::VectorXd own = Eigen::Map<const Eigen::VectorXd>(file.data(), as_index(file.size()));
  const Eigen::Index shared = as_index(shared_parameters(residuals, task));
  own.head(shared) = parameters.head(shared);
  for (const Alike& alike : alike_in(task)) own[as_index(alike.place)] = alike.neutral;
  return own;
}

FitFlight::FitFlight(std::shared_ptr<const FlightSamples> samples, const FitTask& task, const FitSetup& setup)
    : task_(&task),
      setup_(&setup),
      moving_(samples->model.moving.empty() ? nullptr : std::make_shared<FlightSamples>(*samples)),
      residuals_(moving_ ? moving_ : std::move(samples), task.model, task.reference, task.options.mask),
      static_pressure_(residuals_.samples().model.find(Quantity::static_pressure)) {
  const FlightSamples& flight = residuals_.samples();
  kept_ = used_samples(residuals_.mask(), task.options.training_share);
  if (!setup.regimes.empty()) {
    // Of each sample the number of its interval; the first that holds it counts.
    std::vector<int> inside(residuals_.size(), -1);
    for (const Interval& interval : flight.intervals) {
      if (std::find(setup.regimes.begin(), setup.regimes.end(), interval.regime) == setup.regimes.end())
        continue;
      bool any = false;
      for (const std::size_t i : kept_) {
        if (inside[i] >= 0 || flight.time[i] < interval.begin || flight.time[i] >= interval.end) continue;
        inside[i] = static_cast<int>(offset_count_);
        any = true;
      }
      if (any) ++offset_count_;
    }
    kept_.erase(std::remove_if(kept_.begin(), kept_.end(), [&](std::size_t i) { return inside[i] < 0; }),
                kept_.end());
    for (const std::size_t i : kept_) offset_.push_back(inside[i]);
  }
  linear_ = task.reference.model() != nullptr || !task.reference.is_static_pressure() ||
            std::all_of(setup.wanted.begin(), setup.wanted.end(),
                        [this](std::size_t parameter) { return residuals_.is_linear()[parameter]; });
  if (const auto common = residuals_.at_common_pressures())
    at_common_pressures_.emplace(common, task.model, task.reference, task.options.mask);
}

void FitFlight::prepare(const Eigen::VectorXd& parameters) {
  if (parameters.size() == prepared_parameters_.size() && parameters == prepared_parameters_) return;
  prepared_parameters_ = parameters;
  const FlightSamples& flight = residuals_.samples();
  if (moving_) {
    const Eigen::VectorXd own = own_parameters(residuals_, *task_, parameters);
    // As recorded at a higher rate the airspeed stays that of the model as it was read.
    FastSeries& speed = moving_->model.along_beam;
    if (speed.in_record == 1 && !speed.values.empty())
      speed.values = airspeed_along_beam(task_->model, moving_->model, own.data());
    find_moving_columns(task_->model.model, own.data(), flight.time, flight.step, moving_->model);
  }
  std::vector<double> residual(kept_.size());
  for (std::size_t first = 0; first < kept_.size(); first += samples_per_chunk) {
    const std::size_t count = std::min(samples_per_chunk, kept_.size() - first);
    evaluate(residuals_, first, count, parameters, {}, residual.data() + first, nullptr);
  }
  std::vector<double> series(flight.time.size(), nan);
  for (std::size_t i = 0; i < kept_.size(); ++i) series[kept_[i]] = residual[i];
  spikes_ = 0;
  if (task_->options.loss != Loss::none) {
    const std::vector<double> nothing(series.size(), 0.0);
    const std::vector<double> calm = without_outliers(series, nothing, flight.time, flight.step, spikes_);
    for (const std::size_t i : kept_) {
      if (calm[i] != series[i]) series[i] = nan;
    }
  }
  bins_ =
      Binning(series, flight.time, flight.step, std::max(task_->reference.window(), Binning::usual_width));
  bin_.assign(kept_.size(), -1);
  in_bin_ = Eigen::VectorXd::Zero(as_index(bins_.size()));
  std::size_t i = 0;
  for (std::size_t k = 0; k < bins_.records().size(); ++k) {
    while (kept_[i] != bins_.records()[k]) ++i;
    bin_[i] = bins_.bins()[k];
    in_bin_[bin_[i]] += 1.0;
  }
  whitening_.reset();
  kept_rows_.resize(0, 0);
  if (linear_) kept_rows_ = means(parameters, setup_->wanted);
  whiten_what_stays();
}

/// Rows of what is linear, and derivatives by the offsets, each of the pressure in its interval.
void FitFlight::whiten_what_stays() {
  kept_white_rows_ = white(kept_rows_);
  Eigen::MatrixXd offsets = Eigen::MatrixXd::Zero(as_index(bins_.size()), as_index(offset_count_));
  for (std::size_t i = 0; i < offset_.size(); ++i) {
    if (bin_[i] >= 0) offsets(bin_[i], offset_[i]) -= static_pressure(i) / in_bin_[bin_[i]];
  }
  white_offsets_ = white(offsets);
}

void FitFlight::set_noise(const FitNoise& noise, std::size_t flight) {
  NoiseModel own = noise.shared;
  own.level = {level_of_bins(noise.levels[flight], bins_)};
  whitening_.emplace(bins_, own, 0);
  whiten_what_stays();
}

/// Through the chain; for LAMS, where some effect is not at the static ports, in the laser's own measure.
void FitFlight::evaluate(const Residuals& residuals, std::size_t first, std::size_t count,
                         const Eigen::VectorXd& parameters, const std::vector<std::size_t>& wanted,
                         double* residual, double* derivatives) const {
  const std::size_t* const samples = kept_.data() + first;
  const Eigen::VectorXd own = own_parameters(residuals, *task_, parameters);
  const std::size_t shared = shared_parameters(residuals, *task_);
  std::vector<std::size_t> known;
  std::copy_if(wanted.begin(), wanted.end(), std::back_inserter(known),
               [shared](std::size_t parameter) { return parameter < shared; });
  if (linear_) {
    residuals.evaluate(samples, count, own.data(), known, residual, derivatives);
  } else {
    residuals.evaluate_at_sensor(samples, count, own.data(), known, residual, derivatives);
  }
  // Nothing depends on what this reference does not know.
  std::size_t from = known.size();
  for (std::size_t k = wanted.size(); k-- > 0 && from <= k;) {
    double* const column = derivatives + k * count;
    if (wanted[k] < shared) {
      --from;
      std::copy_n(derivatives + from * count, count, column);
    } else {
      std::fill_n(column, count, 0.0);
    }
  }
  for (const Alike& alike : alike_in(*task_)) {
    const auto place = std::find(wanted.begin(), wanted.end(), alike.place);
    if (place != wanted.end())
      std::fill_n(derivatives + (place - wanted.begin()) * as_index(count), count, 0.0);
  }
}

/// Means over the bins of derivatives and residual.
Eigen::MatrixXd FitFlight::means(const Residuals& residuals, const Eigen::VectorXd& parameters,
                                 const std::vector<std::size_t>& wanted) const {
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(as_index(bins_.size()), as_index(wanted.size()) + 1);
  std::vector<double> store((wanted.size() + 1) * samples_per_chunk);
  for (std::size_t first = 0; first < kept_.size(); first += samples_per_chunk) {
    const std::size_t count = std::min(samples_per_chunk, kept_.size() - first);
    double* const residual = store.data() + wanted.size() * count;
    evaluate(residuals, first, count, parameters, wanted, residual, store.data());
    for (std::size_t c = 0; c <= wanted.size(); ++c) {
      const double* const column = store.data() + c * count;
      for (std::size_t i = 0; i < count; ++i) {
        if (bin_[first + i] >= 0) sums(bin_[first + i], as_index(c)) += column[i];
      }
    }
  }
  return in_bin_.cwiseInverse().asDiagonal() * sums;
}

/// The same, with the derivatives of two static systems at common pressures.
Eigen::MatrixXd FitFlight::means(const Eigen::VectorXd& parameters,
                                 const std::vector<std::size_t>& wanted) const {
  if (!at_common_pressures_) return means(residuals_, parameters, wanted);
  Eigen::MatrixXd result = means(*at_common_pressures_, parameters, wanted);
  result.rightCols(1) = means(residuals_, parameters, {});
  return result;
}

/// Linear rows at the parameters that were prepared, with the residual at others.
Eigen::MatrixXd FitFlight::moved(Eigen::MatrixXd rows, const Eigen::VectorXd& parameters) const {
  rows.rightCols(1) += rows.leftCols(rows.cols() - 1) * (parameters - prepared_parameters_)(setup_->wanted);
  return rows;
}

Eigen::MatrixXd FitFlight::rows(const Eigen::VectorXd& parameters) const {
  return linear_ ? moved(kept_rows_, parameters) : means(parameters, setup_->wanted);
}

Eigen::MatrixXd FitFlight::white_rows(const Eigen::VectorXd& parameters, const ScaledLoss& loss) const {
  Eigen::MatrixXd result = linear_ ? moved(kept_white_rows_, parameters) : white(rows(parameters));
  if (offset_count_ == 0) return result;
  Eigen::VectorXd innovations = without_offsets(result.rightCols(1), Eigen::VectorXd::Ones(result.rows()));
  for (const ScaledLoss& each : {loss.convex(), loss}) {
    constexpr int most_rounds = 200;
    for (int round = 0; round < most_rounds && !loss.is_least_squares(); ++round) {
      const Eigen::VectorXd before = innovations;
      innovations = without_offsets(before, each.weights(before));
      if (!((innovations - before).norm() > 1e-12 * innovations.norm())) break;
    }
  }
  result.rightCols(1) = innovations;
  return result;
}

Eigen::MatrixXd FitFlight::without_offsets(const Eigen::MatrixXd& columns,
                                           const Eigen::VectorXd& weights) const {
  if (offset_count_ == 0) return columns;
  const Eigen::MatrixXd weighted = weights.asDiagonal() * white_offsets_;
  return columns - white_offsets_ * (pseudo_inverse(white_offsets_.transpose() * weighted) *
                                     (weighted.transpose() * columns));
}

Eigen::MatrixXd FitFlight::white_columns(const Eigen::VectorXd& parameters,
                                         const std::vector<std::size_t>& wanted) const {
  return white(means(parameters, wanted).leftCols(as_index(wanted.size())));
}

Eigen::MatrixXd FitFlight::unweighted_factor(const Eigen::VectorXd& parameters) const {
  const std::vector<std::size_t>& wanted = setup_->wanted;
  const std::vector<double> ones(samples_per_chunk, 1.0);
  std::vector<double> store((wanted.size() + 1) * samples_per_chunk);
  TriangularFactor factor(as_index(wanted.size()) + 1);
  for (std::size_t first = 0; first < kept_.size(); first += samples_per_chunk) {
    const std::size_t count = std::min(samples_per_chunk, kept_.size() - first);
    std::vector<const double*> columns;
    for (std::size_t c = 0; c <= wanted.size(); ++c) columns.push_back(store.data() + c * count);
    evaluate(residuals_, first, count, parameters, wanted, store.data() + wanted.size() * count,
             store.data());
    factor.add(columns, ones.data(), count);
  }
  return factor.factor();
}

std::size_t FitFlight::outliers(const Eigen::VectorXd& parameters, double limit) const {
  const Eigen::VectorXd innovations = white_rows(parameters, {}).rightCols(1);
  auto count = static_cast<double>(spikes_);
  for (Eigen::Index i = 0; i < innovations.size(); ++i) {
    if (std::abs(innovations[i]) > limit) count += in_bin_[i];
  }
  return static_cast<std::size_t>(count);
}

}  // namespace pcor::internal
