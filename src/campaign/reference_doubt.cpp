#include "campaign/reference_doubt.hpp"

#include <algorithm>
#include <utility>

#include "campaign/model_parameters.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

struct NamedDoubts {
  std::vector<SensorDoubt> sensors{};
  std::vector<std::string> names{};

  void add(const std::vector<SensorDoubt>& more, const std::string& prefix = "") {
    for (const SensorDoubt& doubt : more) names.push_back(prefix + doubt.name());
    sensors.insert(sensors.end(), more.begin(), more.end());
  }
};

/// Calibration uncertainties of the sensors of the model, of its laser, and of a measured pressure.
NamedDoubts model_doubts(const ModelDefinition& model, const Reference& reference) {
  NamedDoubts doubts;
  if (reference.reads_laser()) doubts.add(doubts_of(model, laser_calibration));
  // A measured pressure has no model. An error of the static transducer of the model changes the residual by
  // the same amount with the opposite sign. The sizes come from the catalogue, regardless of the model's
  // statement about its transducer.
  if (reference.is_static_pressure() && !reference.reads_laser() && reference.model() == nullptr)
    doubts.add(doubts_of(ModelDefinition{}, static_calibration), reference.name() + ": ");
  if (model.variables.count(Quantity::recovery_temperature) > 0)
    doubts.add(doubts_of(model, thermometer_calibration));
  return doubts;
}

/// Law of a second system, like "law A of PSFRD/QCFR".
std::string law_of(const ModelDefinition& system) {
  return system.model.name + " of " + system.variable_of(Quantity::static_pressure) + "/" +
         system.variable_of(Quantity::dynamic_pressure);
}

/// Calibration uncertainties of a second system, and the stated uncertainty of its model, as a zero and a
/// gain.
NamedDoubts second_doubts(const ModelDefinition& system, const Reference& reference) {
  NamedDoubts doubts;
  // The variable identifies a sensor: two systems may share it, or have the same name.
  doubts.add(doubts_of(system, static_calibration), system.variable_of(Quantity::static_pressure) + ": ");
  doubts.add(doubts_of(system, dynamic_calibration), system.variable_of(Quantity::dynamic_pressure) + ": ");
  if (!reference.sees_static_defect()) return doubts;
  const StatedUncertainty& stated = system.uncertainty;
  const auto state = [&](const char* effect, const std::optional<double>& size, const char* name) {
    if (!(size.value_or(0.0) > 0.0)) return;
    doubts.sensors.push_back({effect, 0, *size});
    doubts.names.push_back(law_of(system) + ": " + name);
  };
  state("psfd-bias", stated.static_defect, "static_defect");
  state("psfd-gain", stated.static_defect_ratio, "static_defect_ratio");
  return doubts;
}

/// @param model has the effect
std::size_t position_of(const ModelDefinition& model, const SensorDoubt& doubt) {
  return *first_parameter_of(model, doubt.effect) + doubt.parameter;
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

ReferenceDoubt::ReferenceDoubt(const ModelDefinition& model, const Reference& reference, bool trusted,
                               bool with_law)
    : model_parameters_(parameter_count(model.model)),
      reference_parameters_(reference.model() != nullptr ? parameter_count(reference.model()->model) : 0) {
  if (with_law && reference.model() != nullptr) law_root_ = root_of_law(*reference.model());
  if (trusted && law_root_.cols() == 0) return;
  NamedDoubts doubts;
  if (!trusted) doubts = model_doubts(model, reference);
  model_ = with_doubts(model, doubts.sensors);
  for (const SensorDoubt& each : doubts.sensors) indices_.push_back(position_of(model_, each));
  if (reference.model() != nullptr) {
    NamedDoubts second;
    if (!trusted) second = second_doubts(*reference.model(), reference);
    const ModelDefinition system = with_doubts(*reference.model(), second.sensors);
    reference_ = reference.with_model(system);
    for (const SensorDoubt& each : second.sensors)
      indices_.push_back(parameter_count(model_.model) + position_of(system, each));
    doubts.sensors.insert(doubts.sensors.end(), second.sensors.begin(), second.sensors.end());
    doubts.names.insert(doubts.names.end(), second.names.begin(), second.names.end());
  } else {
    reference_ = std::shared_ptr<const Reference>(std::shared_ptr<const Reference>(), &reference);
  }
  names_ = doubts.names;
  sizes_ = Eigen::VectorXd::Ones(as_index(names_.size()) + law_root_.cols());
  for (std::size_t k = 0; k < names_.size(); ++k) sizes_[as_index(k)] = doubts.sensors[k].size;
  for (Eigen::Index k = 0; k < law_root_.rows() && law_root_.cols() > 0; ++k)
    indices_.push_back(parameter_count(model_.model) + static_cast<std::size_t>(k));
  for (Eigen::Index k = 0; k < law_root_.cols(); ++k)
    names_.push_back(law_of(*reference.model()) + ": law, direction " + std::to_string(k + 1));
}

Eigen::MatrixXd ReferenceDoubt::columns(const std::shared_ptr<const FlightSamples>& flight,
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
