#include "fit/fit_flights.hpp"

#include <map>
#include <optional>

#include "campaign/model_parameters.hpp"
#include "numerics/missing.hpp"
#include "numerics/spikes.hpp"
#include "residuals/parameter_dependent_columns.hpp"

namespace pcor::internal {

namespace {

/// Neutral values of the coefficients of effects that the model and the reference's model share, by their
/// indices among the parameters of residuals.
std::map<std::size_t, double> neutral_parameters(const FitTask& task) {
  std::map<std::size_t, double> result;
  const ModelDefinition* const other = task.reference.model();
  if (other == nullptr) return result;
  for (const std::string& effect : task.options.shared_effects) {
    const std::vector<double> neutral = neutral_effect(effect).parameters;
    const auto add = [&](const ModelDefinition& model, std::size_t first) {
      const std::optional<std::size_t> position = first_parameter_of(model, effect);
      for (std::size_t i = 0; position && i < neutral.size(); ++i)
        result.emplace(first + *position + i, neutral[i]);
    };
    add(task.model, 0);
    add(*other, parameter_count(task.model.model));
  }
  return result;
}

/// Number of first fit parameters that are also the first parameters of the residuals.
std::size_t shared_parameters(const Residuals& residuals, const FitTask& task) {
  return task.shares_system ? residuals.parameters().size() : parameter_count(task.model.model);
}

}  // namespace

Eigen::VectorXd flight_parameters(const Residuals& residuals, const FitTask& task,
                                  const Eigen::VectorXd& parameters) {
  const std::vector<double>& file = residuals.parameters();
  Eigen::VectorXd coefficients = Eigen::Map<const Eigen::VectorXd>(file.data(), as_index(file.size()));
  const Eigen::Index shared = as_index(shared_parameters(residuals, task));
  coefficients.head(shared) = parameters.head(shared);
  for (const auto& [position, neutral] : neutral_parameters(task)) coefficients[as_index(position)] = neutral;
  return coefficients;
}

Residuals residuals_at(std::shared_ptr<const FlightSamples> samples, const FitTask& task,
                       const Eigen::VectorXd& parameters, std::vector<Mask>& mask) {
  Residuals residuals(std::move(samples), task.model, task.reference, mask);
  if (mask.empty()) {
    mask = residuals.masks_at(flight_parameters(residuals, task, parameters).data(), task.options.mask);
    residuals.set_mask(mask);
  }
  return residuals;
}

Eigen::MatrixXd sample_rows(const LinearRows& rows, const FitTask& task,
                            const std::vector<std::size_t>& samples, const Eigen::VectorXd& parameters,
                            const std::vector<std::size_t>& requested, bool as_recorded) {
  const std::map<std::size_t, double> neutral = neutral_parameters(task);
  std::vector<std::size_t> known;
  std::vector<std::size_t> columns;
  for (std::size_t k = 0; k < requested.size(); ++k) {
    if (neutral.count(requested[k]) != 0 || requested[k] >= shared_parameters(rows.residuals(), task))
      continue;
    known.push_back(requested[k]);
    columns.push_back(k);
  }
  columns.push_back(requested.size());
  const Eigen::VectorXd coefficients = flight_parameters(rows.residuals(), task, parameters);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(as_index(samples.size()), as_index(requested.size()) + 1);
  all(Eigen::all, columns) = rows.evaluate(samples, coefficients.data(), known, as_recorded);
  return all;
}

FitFlight::FitFlight(std::shared_ptr<const FlightSamples> samples, const FitTask& task, const FitSetup& setup,
                     const Eigen::VectorXd& parameters, std::vector<Mask>& mask)
    : task_(&task),
      recomputed_samples_(
          samples->model.parameter_dependent.empty() ? nullptr : std::make_shared<FlightSamples>(*samples)),
      rows_(residuals_at(recomputed_samples_ ? recomputed_samples_ : std::move(samples), task, setup.values,
                         mask),
            task.model, task.reference,
            {Inputs::recorded, setup.requested, task.options.training_share, setup.regimes}) {
  if (!recomputed_samples_) return;
  const Eigen::VectorXd coefficients = flight_parameters(residuals(), task, parameters);
  // The high-rate airspeed remains that of the input model.
  FastSeries& speed = recomputed_samples_->model.along_beam;
  if (speed.in_record == 1 && !speed.values.empty())
    speed.values = airspeed_along_beam(task.model, recomputed_samples_->model, coefficients.data());
  find_parameter_dependent_columns(task.model.model, coefficients.data(), recomputed_samples_->time,
                                   recomputed_samples_->step, recomputed_samples_->model);
}

bool FitFlight::masks_change_at(const Eigen::VectorXd& parameters) const {
  const Eigen::VectorXd coefficients = flight_parameters(residuals(), *task_, parameters);
  return residuals().masks_at(coefficients.data(), task_->options.mask) != residuals().mask();
}

Binning FitFlight::bins(const Eigen::VectorXd& parameters, std::size_t& spikes) const {
  const FlightSamples& flight = rows_.samples();
  const Eigen::VectorXd residual = sample_rows(rows_, *task_, kept(), parameters, {}, false);
  std::vector<double> series(flight.time.size(), nan);
  for (std::size_t i = 0; i < kept().size(); ++i) series[kept()[i]] = residual[as_index(i)];
  spikes = 0;
  if (task_->options.loss != Loss::none) {
    const std::vector<double> nothing(series.size(), 0.0);
    const std::vector<double> calm = without_outliers(series, nothing, flight.time, flight.step, spikes);
    for (const std::size_t i : kept()) {
      if (calm[i] != series[i]) series[i] = nan;
    }
  }
  return rows_.bins(series);
}

Eigen::MatrixXd FitFlight::by_offsets(const Binning& bins) const {
  Eigen::MatrixXd offsets = Eigen::MatrixXd::Zero(as_index(bins.size()), as_index(rows_.interval_count()));
  const std::vector<double>& static_pressure = *rows_.samples().model.find(Quantity::static_pressure);
  for (std::size_t k = 0; k < bins.records().size() && offsets.cols() > 0; ++k) {
    const std::size_t record = bins.records()[k];
    const Eigen::Index bin = bins.bins()[k];
    offsets(bin, as_index(rows_.intervals()[record])) -= static_pressure[record] / bins.counts()[bin];
  }
  return offsets;
}

}  // namespace pcor::internal
