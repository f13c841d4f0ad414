#include "campaign/reference_doubt.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "campaign/model_parameters.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

/// Of the model that is held against the reference.
std::vector<SensorDoubt> own_doubts(const ModelFile& model, const Reference& reference) {
  std::vector<SensorDoubt> doubts;
  const auto add = [&](const std::vector<std::string_view>& effects) {
    const std::vector<SensorDoubt> more = doubts_of(model, effects);
    doubts.insert(doubts.end(), more.begin(), more.end());
  };
  if (reference.reads_laser()) add(laser_calibration);
  // A pressure that was measured or corrected elsewhere has no model of its own. An error of the static
  // transducer of the model changes the residual by as much, with the other sign.
  if (reference.is_static_pressure() && !reference.reads_laser() && reference.model() == nullptr)
    add({"psfd-bias", "psfd-gain", "psfd-drift"});
  if (model.variables.count(Quantity::recovery_temperature) > 0) add(thermometer_calibration);
  return doubts;
}

/// Of the law of a second system.
std::vector<SensorDoubt> second_doubts(const ModelFile& system) {
  std::vector<SensorDoubt> doubts = doubts_of(system, pressure_calibration);
  for (SensorDoubt& doubt : doubts) {
    if (doubt.effect == "psfd-bias")
      doubt.size = std::hypot(doubt.size, system.uncertainty.static_defect.value_or(0.0));
    if (doubt.effect == "psfd-gain")
      doubt.size = std::hypot(doubt.size, system.uncertainty.static_defect_ratio.value_or(0.0));
  }
  return doubts;
}

std::size_t place_of(const ModelFile& model, const SensorDoubt& doubt) {
  std::size_t place = doubt.parameter;
  for (const ModelEffect& effect : model.model.effects) {
    if (effect.id == doubt.effect) break;
    place += effect.parameters.size();
  }
  return place;
}

/// The samples with the time since the first, which drifts need, among the inputs of both models.
std::shared_ptr<const FlightSamples> with_time(const std::shared_ptr<const FlightSamples>& flight) {
  auto result = std::make_shared<FlightSamples>(*flight);
  for (ModelSamples* const samples : {&result->model, &result->reference}) {
    if (samples->find(Quantity::time) != nullptr) continue;
    std::vector<double> time = flight->time;
    for (double& each : time) each -= flight->time.front();
    samples->columns.emplace_back(Quantity::time, std::move(time));
    samples->roles.push_back(Quantity::time);
  }
  return result;
}

}  // namespace

ReferenceDoubt::ReferenceDoubt(const ModelFile& model, const Reference& reference, bool trusted)
    : model_parameters_(parameter_count(model.model)),
      reference_parameters_(reference.model() != nullptr ? parameter_count(reference.model()->model) : 0) {
  if (trusted) return;
  const std::vector<SensorDoubt> own = own_doubts(model, reference);
  std::vector<SensorDoubt> second;
  model_ = with_doubts(model, own);
  for (const SensorDoubt& doubt : own) places_.push_back(place_of(model_, doubt));
  if (reference.model() != nullptr) {
    second = second_doubts(*reference.model());
    const ModelFile system = with_doubts(*reference.model(), second);
    reference_ = reference.with_model(system);
    for (const SensorDoubt& doubt : second)
      places_.push_back(parameter_count(model_.model) + place_of(system, doubt));
  } else {
    reference_ = std::shared_ptr<const Reference>(std::shared_ptr<const Reference>(), &reference);
  }
  sizes_.resize(as_index(own.size() + second.size()));
  for (const SensorDoubt& doubt : own) {
    sizes_[as_index(names_.size())] = doubt.size;
    names_.push_back(doubt.name());
  }
  for (const SensorDoubt& doubt : second) {
    sizes_[as_index(names_.size())] = doubt.size;
    names_.push_back(reference.model()->model.name + ": " + doubt.name());
  }
}

Eigen::MatrixXd ReferenceDoubt::columns(const std::shared_ptr<const FlightSamples>& flight,
                                        const std::vector<std::size_t>& samples,
                                        const double* parameters) const {
  Eigen::MatrixXd derivatives(as_index(samples.size()), as_index(names_.size()));
  if (empty() || samples.empty()) return derivatives;
  const Residuals residuals(with_time(flight), model_, *reference_, std::vector<Mask>());
  std::vector<double> all = residuals.parameters();
  std::copy(parameters, parameters + model_parameters_, all.begin());
  std::copy(parameters + model_parameters_, parameters + model_parameters_ + reference_parameters_,
            all.begin() + static_cast<std::ptrdiff_t>(parameter_count(model_.model)));
  std::vector<double> residual(samples.size());
  residuals.evaluate(samples.data(), samples.size(), all.data(), places_, residual.data(),
                     derivatives.data());
  return derivatives * sizes_.asDiagonal();
}

}  // namespace pcor::internal
