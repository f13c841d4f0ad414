#include "campaign/reference_doubt.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "campaign/model_parameters.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

struct NamedDoubt {
  SensorDoubt doubt;
  std::string name;
};

void add(std::vector<NamedDoubt>& doubts, const std::vector<SensorDoubt>& more,
         const std::string& prefix = "") {
  for (const SensorDoubt& doubt : more) doubts.push_back({doubt, prefix + doubt.name()});
}

/// Calibration uncertainties of the sensors of the model, of its laser, and of a measured pressure.
std::vector<NamedDoubt> own_doubts(const ModelDefinition& model, const Reference& reference) {
  std::vector<NamedDoubt> doubts;
  if (reference.reads_laser()) add(doubts, doubts_of(model, laser_calibration));
  // A measured pressure has no model. An error of the static transducer of the model changes the residual by
  // the same amount with the opposite sign. The sizes come from the catalogue, regardless of the model's
  // statement about its transducer.
  if (reference.is_static_pressure() && !reference.reads_laser() && reference.model() == nullptr)
    add(doubts, doubts_of(ModelDefinition{}, {"psfd-bias", "psfd-gain", "psfd-drift"}),
        reference.name() + ": ");
  if (model.variables.count(Quantity::recovery_temperature) > 0)
    add(doubts, doubts_of(model, thermometer_calibration));
  return doubts;
}

/// Calibration uncertainties of a second system, and the stated uncertainty of its model, as a zero and a
/// gain.
std::vector<NamedDoubt> second_doubts(const ModelDefinition& system, const Reference& reference) {
  const std::string prefix = system.model.name + ": ";
  std::vector<NamedDoubt> doubts;
  add(doubts, doubts_of(system, pressure_calibration), prefix);
  if (!reference.sees_static_defect()) return doubts;
  const StatedUncertainty& stated = system.uncertainty;
  const auto state = [&](const char* effect, const std::optional<double>& size, const char* name) {
    if (!(size.value_or(0.0) > 0.0)) return;
    NamedDoubt& stated_doubt = doubts.emplace_back();
    stated_doubt.doubt.effect = effect;
    stated_doubt.doubt.size = *size;
    stated_doubt.name = prefix + name;
  };
  state("psfd-bias", stated.static_defect, "static_defect");
  state("psfd-gain", stated.static_defect_ratio, "static_defect_ratio");
  return doubts;
}

ModelDefinition with_effects_of(const ModelDefinition& model, const std::vector<NamedDoubt>& doubts) {
  std::vector<SensorDoubt> sensors;
  for (const NamedDoubt& each : doubts) sensors.push_back(each.doubt);
  return with_doubts(model, sensors);
}

/// @param model has the effect
std::size_t position_of(const ModelDefinition& model, const SensorDoubt& doubt) {
  return *first_parameter_of(model, doubt.effect) + doubt.parameter;
}

/// Samples with the time since the first, which drifts require, among the inputs of both models.
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

ReferenceDoubt::ReferenceDoubt(const ModelDefinition& model, const Reference& reference, bool trusted)
    : model_parameters_(parameter_count(model.model)),
      reference_parameters_(reference.model() != nullptr ? parameter_count(reference.model()->model) : 0) {
  if (trusted) return;
  std::vector<NamedDoubt> doubts = own_doubts(model, reference);
  model_ = with_effects_of(model, doubts);
  for (const NamedDoubt& each : doubts) indices_.push_back(position_of(model_, each.doubt));
  if (reference.model() != nullptr) {
    const std::vector<NamedDoubt> second = second_doubts(*reference.model(), reference);
    const ModelDefinition system = with_effects_of(*reference.model(), second);
    reference_ = reference.with_model(system);
    for (const NamedDoubt& each : second)
      indices_.push_back(parameter_count(model_.model) + position_of(system, each.doubt));
    doubts.insert(doubts.end(), second.begin(), second.end());
  } else {
    reference_ = std::shared_ptr<const Reference>(std::shared_ptr<const Reference>(), &reference);
  }
  sizes_.resize(as_index(doubts.size()));
  for (const NamedDoubt& each : doubts) {
    sizes_[as_index(names_.size())] = each.doubt.size;
    names_.push_back(each.name);
  }
}

Eigen::MatrixXd ReferenceDoubt::columns(const std::shared_ptr<const FlightSamples>& flight,
                                        const std::vector<std::size_t>& samples,
                                        const double* parameters) const {
  Eigen::MatrixXd derivatives(as_index(samples.size()), as_index(names_.size()));
  if (empty() || samples.empty()) return derivatives;
  const Residuals residuals(with_time(flight), model_, *reference_, std::vector<Mask>());
  std::vector<double> all = residuals.parameters();
  if (parameters != nullptr) {
    std::copy(parameters, parameters + model_parameters_, all.begin());
    std::copy(parameters + model_parameters_, parameters + model_parameters_ + reference_parameters_,
              all.begin() + static_cast<std::ptrdiff_t>(parameter_count(model_.model)));
  }
  std::vector<double> residual(samples.size());
  residuals.evaluate(samples.data(), samples.size(), all.data(), indices_, residual.data(),
                     derivatives.data());
  return derivatives * sizes_.asDiagonal();
}

}  // namespace pcor::internal
