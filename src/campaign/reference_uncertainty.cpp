#include "campaign/reference_uncertainty.hpp"

#include <algorithm>
#include <utility>

#include "campaign/model_parameters.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

struct NamedUncertainties {
  std::vector<SensorUncertainty> sensors{};
  std::vector<std::string> names{};

  void add(const std::vector<SensorUncertainty>& more, const std::string& prefix = "") {
    for (const SensorUncertainty& uncertainty : more) names.push_back(prefix + uncertainty.name());
    sensors.insert(sensors.end(), more.begin(), more.end());
  }
};

/// Calibration uncertainties of the sensors of the model, of its laser, and of a measured pressure.
NamedUncertainties sensor_uncertainties(const ModelDefinition& model, const Reference& reference) {
  NamedUncertainties uncertainties;
  if (reference.reads_laser()) uncertainties.add(uncertainties_of(model, laser_calibration));
  // A measured pressure has no model. An error of the static transducer of the model changes the residual by
  // the same amount with the opposite sign. The sizes come from the catalogue, regardless of the model's
  // statement about its transducer.
  if (reference.is_static_pressure() && !reference.reads_laser() && reference.model() == nullptr)
    uncertainties.add(uncertainties_of(ModelDefinition{}, static_calibration), reference.name() + ": ");
  if (model.variables.count(Quantity::recovery_temperature) > 0)
    uncertainties.add(uncertainties_of(model, thermometer_calibration));
  return uncertainties;
}

/// Law of a second system, like "law A of PSFRD/QCFR".
std::string law_of(const ModelDefinition& system) {
  return system.model.name + " of " + system.variable_of(Quantity::static_pressure) + "/" +
         system.variable_of(Quantity::dynamic_pressure);
}

/// Calibration uncertainties of a second system, and the stated uncertainty of its model, as a zero and a
/// gain.
NamedUncertainties second_uncertainties(const ModelDefinition& system, const Reference& reference) {
  NamedUncertainties uncertainties;
  // The variable identifies a sensor: two systems may share it, or have the same name.
  uncertainties.add(uncertainties_of(system, static_calibration),
                    system.variable_of(Quantity::static_pressure) + ": ");
  uncertainties.add(uncertainties_of(system, dynamic_calibration),
                    system.variable_of(Quantity::dynamic_pressure) + ": ");
  if (!reference.sees_static_defect()) return uncertainties;
  const StatedUncertainty& stated = system.uncertainty;
  const auto state = [&](const char* effect, const std::optional<double>& size, const char* name) {
    if (!(size.value_or(0.0) > 0.0)) return;
    uncertainties.sensors.push_back({effect, 0, *size});
    uncertainties.names.push_back(law_of(system) + ": " + name);
  };
  state("psfd-bias", stated.static_defect, "static_defect");
  state("psfd-gain", stated.static_defect_ratio, "static_defect_ratio");
  return uncertainties;
}

/// @param model has the effect
std::size_t position_of(const ModelDefinition& model, const SensorUncertainty& uncertainty) {
  return *first_parameter_of(model, uncertainty.effect) + uncertainty.parameter;
}

/// Square root of the stated covariance of a law: a row for each parameter of its effects, a column for each
/// parameter with an error.
Eigen::MatrixXd root_of_law(const ModelDefinition& law) {
  const Eigen::MatrixXd covariance = stated_covariance(law);
  std::vector<Eigen::Index> known;
  for (Eigen::Index k = 0; k < covariance.rows(); ++k) {
    if (covariance(k, k) > 0.0) known.push_back(k);
  }
  if (known.empty()) return Eigen::MatrixXd::Zero(covariance.rows(), 0);
  return covariance_root(covariance)(Eigen::all, known);
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

ReferenceUncertainty::ReferenceUncertainty(const ModelDefinition& model, const Reference& reference,
                                           bool trusted, bool with_law)
    : model_parameters_(parameter_count(model.model)),
      reference_parameters_(reference.model() != nullptr ? parameter_count(reference.model()->model) : 0) {
  if (with_law && reference.model() != nullptr) law_root_ = root_of_law(*reference.model());
  if (trusted && law_root_.cols() == 0) return;
  NamedUncertainties uncertainties;
  if (!trusted) uncertainties = sensor_uncertainties(model, reference);
  model_ = with_uncertain_sensors(model, uncertainties.sensors);
  for (const SensorUncertainty& each : uncertainties.sensors) indices_.push_back(position_of(model_, each));
  if (reference.model() != nullptr) {
    NamedUncertainties second;
    if (!trusted) second = second_uncertainties(*reference.model(), reference);
    const ModelDefinition system = with_uncertain_sensors(*reference.model(), second.sensors);
    reference_ = reference.with_model(system);
    for (const SensorUncertainty& each : second.sensors)
      indices_.push_back(parameter_count(model_.model) + position_of(system, each));
    uncertainties.sensors.insert(uncertainties.sensors.end(), second.sensors.begin(), second.sensors.end());
    uncertainties.names.insert(uncertainties.names.end(), second.names.begin(), second.names.end());
  } else {
    reference_ = std::shared_ptr<const Reference>(std::shared_ptr<const Reference>(), &reference);
  }
  names_ = uncertainties.names;
  sizes_ = Eigen::VectorXd::Ones(as_index(names_.size()) + law_root_.cols());
  for (std::size_t k = 0; k < names_.size(); ++k) sizes_[as_index(k)] = uncertainties.sensors[k].size;
  for (Eigen::Index k = 0; k < law_root_.rows() && law_root_.cols() > 0; ++k)
    indices_.push_back(parameter_count(model_.model) + static_cast<std::size_t>(k));
  for (Eigen::Index k = 0; k < law_root_.cols(); ++k)
    names_.push_back(law_of(*reference.model()) + ": law, direction " + std::to_string(k + 1));
}

Eigen::MatrixXd ReferenceUncertainty::columns(const std::shared_ptr<const FlightSamples>& flight,
                                              const std::vector<std::size_t>& samples,
                                              const double* parameters) const {
  if (empty() || samples.empty())
    return Eigen::MatrixXd::Zero(as_index(samples.size()), as_index(names_.size()));
  Eigen::MatrixXd derivatives(as_index(samples.size()), as_index(indices_.size()));
  const Residuals residuals(with_time(flight), model_, *reference_, std::vector<Mask>());
  std::vector<double> all = residuals.parameters();
  if (parameters != nullptr) {
    std::copy(parameters, parameters + model_parameters_, all.begin());
    std::copy(parameters + model_parameters_, parameters + model_parameters_ + reference_parameters_,
              all.begin() + static_cast<std::ptrdiff_t>(parameter_count(model_.model)));
  }
  std::vector<double> residual(samples.size());
  residuals.evaluate(samples, all.data(), indices_, residual.data(), derivatives.data());
  const Eigen::Index sensors = as_index(names_.size()) - law_root_.cols();
  Eigen::MatrixXd changes(derivatives.rows(), as_index(names_.size()));
  changes.leftCols(sensors) = derivatives.leftCols(sensors) * sizes_.head(sensors).asDiagonal();
  if (law_root_.cols() > 0)
    changes.rightCols(law_root_.cols()) = derivatives.rightCols(law_root_.rows()) * law_root_;
  return changes;
}

}  // namespace pcor::internal
