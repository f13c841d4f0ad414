#include "fit/fit_flights.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "campaign/model_parameters.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"
#include "numerics/noise_covariance.hpp"
#include "numerics/spikes.hpp"
#include "residuals/moving_columns.hpp"

namespace pcor::internal {

namespace {

/// Coefficient of an effect shared by the model and the reference's model, and its neutral value.
struct Alike {
  std::size_t place;  ///< index among the parameters of residuals
  double neutral;
};

std::vector<Alike> alike_in(const FitTask& task) {
  std::vector<Alike> alike;
  const ModelDefinition* const other = task.reference.model();
  if (other == nullptr) return alike;
  for (const std::string& effect : task.options.alike) {
    const std::vector<double> neutral = neutral_effect(effect).parameters;
    const auto add = [&](const ModelDefinition& model, std::size_t first) {
      const std::optional<std::size_t> place = first_parameter_of(model, effect);
      for (std::size_t i = 0; place && i < neutral.size(); ++i)
        alike.push_back({first + *place + i, neutral[i]});
    };
    add(task.model, 0);
    add(*other, parameter_count(task.model.model));
  }
  return alike;
}

/// The wanted parameters on which the residuals of a flight depend.
struct Known {
  std::vector<std::size_t> parameters{};
  std::vector<std::size_t> columns{};  ///< indices among the wanted ones, and that of the residual
};

Known known_of(const std::vector<std::size_t>& wanted, const Residuals& residuals, const FitTask& task) {
  const std::vector<Alike> alike = alike_in(task);
  Known known;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const bool is_alike =
        std::any_of(alike.begin(), alike.end(), [&](const Alike& each) { return each.place == wanted[k]; });
    if (is_alike || wanted[k] >= shared_parameters(residuals, task)) continue;
    known.parameters.push_back(wanted[k]);
    known.columns.push_back(k);
  }
  known.columns.push_back(wanted.size());
  return known;
}

/// Derivatives by parameters unknown to a reference are zero. @param rows of the known parameters
Eigen::MatrixXd with_all_columns(const Eigen::MatrixXd& rows, const Known& known) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rows.rows(), as_index(known.columns.back()) + 1);
  all(Eigen::all, known.columns) = rows;
  return all;
}

}  // namespace

std::size_t shared_parameters(const Residuals& residuals, const FitTask& task) {
  return task.shares_system ? residuals.parameters().size() : parameter_count(task.model.model);
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

Residuals residuals_at(std::shared_ptr<const FlightSamples> samples, const FitTask& task,
                       const Eigen::VectorXd& parameters) {
  Residuals residuals(std::move(samples), task.model, task.reference, std::vector<Mask>());
  residuals.set_mask(
      residuals.masks_at(own_parameters(residuals, task, parameters).data(), task.options.mask));
  return residuals;
}

Eigen::VectorXd mean_derivatives(const LinearRows& rows, const FitTask& task,
                                 const std::vector<std::size_t>& samples, const Eigen::VectorXd& parameters,
                                 const std::vector<std::size_t>& wanted) {
  const Known known = known_of(wanted, rows.residuals(), task);
  const Eigen::VectorXd own = own_parameters(rows.residuals(), task, parameters);
  const Eigen::MatrixXd all =
      with_all_columns(rows.evaluate(samples, own.data(), known.parameters, true), known);
  return all.leftCols(as_index(wanted.size())).colwise().mean().transpose();
}

FitFlight::FitFlight(std::shared_ptr<const FlightSamples> samples, const FitTask& task, const FitSetup& setup)
    : task_(&task),
      setup_(&setup),
      moving_(samples->model.moving.empty() ? nullptr : std::make_shared<FlightSamples>(*samples)),
      rows_(residuals_at(moving_ ? moving_ : std::move(samples), task, setup.values), task.model,
            task.reference, {Inputs::recorded, setup.wanted, task.options.training_share, setup.regimes}),
      static_pressure_(rows_.samples().model.find(Quantity::static_pressure)) {}

bool FitFlight::masks_change_at(const Eigen::VectorXd& parameters) const {
  const Eigen::VectorXd own = own_parameters(residuals(), *task_, parameters);
  return residuals().masks_at(own.data(), task_->options.mask) != residuals().mask();
}

void FitFlight::prepare(const Eigen::VectorXd& parameters) {
  if (parameters.size() == prepared_parameters_.size() && parameters == prepared_parameters_) return;
  prepared_parameters_ = parameters;
  const FlightSamples& flight = rows_.samples();
  const Eigen::VectorXd own = own_parameters(residuals(), *task_, parameters);
  if (moving_) {
    // The high-rate airspeed remains that of the input model.
    FastSeries& speed = moving_->model.along_beam;
    if (speed.in_record == 1 && !speed.values.empty())
      speed.values = airspeed_along_beam(task_->model, moving_->model, own.data());
    find_moving_columns(task_->model.model, own.data(), flight.time, flight.step, moving_->model);
  }
  const Eigen::VectorXd residual = rows_.evaluate(kept(), own.data(), {});
  std::vector<double> series(flight.time.size(), nan);
  for (std::size_t i = 0; i < kept().size(); ++i) series[kept()[i]] = residual[as_index(i)];
  spikes_ = 0;
  if (task_->options.loss != Loss::none) {
    const std::vector<double> nothing(series.size(), 0.0);
    const std::vector<double> calm = without_outliers(series, nothing, flight.time, flight.step, spikes_);
    for (const std::size_t i : kept()) {
      if (calm[i] != series[i]) series[i] = nan;
    }
  }
  bins_ = rows_.bins(series);
  whitening_.reset();
  scale_.resize(0);
  kept_rows_.resize(0, 0);
  if (rows_.is_linear()) kept_rows_ = means(parameters, setup_->wanted);
  whiten_what_stays();
}

/// Linear rows, and derivatives by the offsets, each of the pressure in its interval.
void FitFlight::whiten_what_stays() {
  kept_white_rows_ = white(kept_rows_);
  Eigen::MatrixXd offsets = Eigen::MatrixXd::Zero(as_index(bins_.size()), as_index(this->offsets()));
  for (std::size_t k = 0; k < bins_.records().size() && this->offsets() > 0; ++k) {
    const std::size_t record = bins_.records()[k];
    const Eigen::Index bin = bins_.bins()[k];
    offsets(bin, as_index(rows_.intervals()[record])) -= (*static_pressure_)[record] / bins_.counts()[bin];
  }
  white_offsets_ = white(offsets);
}

void FitFlight::set_noise(const FitNoise& noise, std::size_t flight) {
  noise_ = noise.shared;
  noise_.level = {level_of_bins(noise.levels[flight], bins_)};
  if (task_->reference.is_of_one_sample()) {
    if (bins_.size() > 0) scale_ = (bins_.counts() / bins_.counts().maxCoeff()).cwiseSqrt() / noise.deviation;
  } else {
    whitening_.emplace(bins_, noise_, 0);
  }
  whiten_what_stays();
}

Eigen::MatrixXd FitFlight::white(const Eigen::MatrixXd& columns) const {
  if (columns.rows() == 0) return columns;
  if (whitening_) return (*whitening_)(columns);
  return scale_.size() > 0 ? Eigen::MatrixXd(scale_.asDiagonal() * columns) : columns;
}

Eigen::MatrixXd FitFlight::covariance_of_sums(const Eigen::MatrixXd& columns) const {
  return noise_covariance(columns, bins_, noise_, 0);
}

double FitFlight::information() const {
  if (bins_.size() == 0) return 0.0;
  const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(as_index(bins_.size()), 1);
  const auto count = static_cast<double>(bins_.size());
  return count * count / noise_covariance(ones, bins_, noise_, 0)(0, 0);
}

/// Means over the bins of derivatives and residual.
Eigen::MatrixXd FitFlight::means(const Eigen::VectorXd& parameters,
                                 const std::vector<std::size_t>& wanted) const {
  const Known known = known_of(wanted, residuals(), *task_);
  const Eigen::VectorXd own = own_parameters(residuals(), *task_, parameters);
  return with_all_columns(rows_.means(bins_, own.data(), known.parameters), known);
}

/// Linear rows at the prepared parameters, with the residual at other parameters.
Eigen::MatrixXd FitFlight::moved(Eigen::MatrixXd rows, const Eigen::VectorXd& parameters) const {
  rows.rightCols(1) += rows.leftCols(rows.cols() - 1) * (parameters - prepared_parameters_)(setup_->wanted);
  return rows;
}

Eigen::MatrixXd FitFlight::rows(const Eigen::VectorXd& parameters) const {
  return rows_.is_linear() ? moved(kept_rows_, parameters) : means(parameters, setup_->wanted);
}

Eigen::MatrixXd FitFlight::white_rows(const Eigen::VectorXd& parameters, const ScaledLoss& loss) const {
  Eigen::MatrixXd result = rows_.is_linear() ? moved(kept_white_rows_, parameters) : white(rows(parameters));
  if (offsets() == 0) return result;
  Eigen::VectorXd innovations = without_offsets(result.rightCols(1), Eigen::VectorXd::Ones(result.rows()));
  for (const ScaledLoss& each : {loss.convex(), loss}) {
    constexpr int max_rounds = 200;
    for (int round = 0; round < max_rounds && !loss.is_least_squares(); ++round) {
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
  if (offsets() == 0) return columns;
  const Eigen::MatrixXd weighted = weights.asDiagonal() * white_offsets_;
  return columns - white_offsets_ * (pseudo_inverse(white_offsets_.transpose() * weighted) *
                                     (weighted.transpose() * columns));
}

Eigen::MatrixXd FitFlight::white_columns(const Eigen::VectorXd& parameters,
                                         const std::vector<std::size_t>& wanted) const {
  return white(means(parameters, wanted).leftCols(as_index(wanted.size())));
}

Eigen::MatrixXd FitFlight::white_doubts(const ReferenceDoubt& doubt,
                                        const Eigen::VectorXd& parameters) const {
  const Eigen::VectorXd own = own_parameters(residuals(), *task_, parameters);
  return white(rows_.bin_means(bins_, doubt.columns(residuals().shared_samples(), kept(), own.data())));
}

Eigen::MatrixXd FitFlight::unweighted_factor(const Eigen::VectorXd& parameters) const {
  const Known known = known_of(setup_->wanted, residuals(), *task_);
  const Eigen::VectorXd own = own_parameters(residuals(), *task_, parameters);
  const Eigen::MatrixXd rows =
      with_all_columns(rows_.evaluate(kept(), own.data(), known.parameters, true), known);
  TriangularFactor factor(rows.cols());
  factor.add(rows, Eigen::VectorXd::Ones(rows.rows()));
  return factor.factor();
}

std::size_t FitFlight::outliers(const Eigen::VectorXd& parameters, double limit) const {
  const Eigen::VectorXd innovations = white_rows(parameters, {}).rightCols(1);
  auto count = static_cast<double>(spikes_);
  for (Eigen::Index i = 0; i < innovations.size(); ++i) {
    if (std::abs(innovations[i]) > limit) count += bins_.counts()[i];
  }
  return static_cast<std::size_t>(count);
}

}  // namespace pcor::internal
