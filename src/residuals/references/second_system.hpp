#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pcor/residuals/reference.hpp>
#include "residuals/model_on_samples.hpp"
#include "residuals/reference_on_samples.hpp"
#include "residuals/samples.hpp"

namespace pcor::internal {

/// Corrected static pressures, or total pressures.
enum class ComparedPressure { static_pressure, total_pressure };

/// Second system on the samples of a flight, with its inputs and its model.
class SecondSystemOnSamples final : public ReferenceOnSamples {
 public:
  SecondSystemOnSamples(const ModelDefinition& system, ComparedPressure compared,
                        const FlightSamples& samples, const ModelOnSamples& model)
      : second_(system, samples.reference), model_(model), compared_(compared) {}

  void residuals(const Block& block, const double* parameters, double* out) const override {
    const std::size_t count = block.samples.size();
    std::vector<double> of_model(count);
    const Quantity added = is_total() ? Quantity::port_dynamic_pressure : Quantity::static_defect;
    model_.port_pressure_plus(added, block.model, count, parameters, of_model.data());
    second_.port_pressure_plus(added, block.reference, count, parameters_of_second(parameters), out);
    for (std::size_t i = 0; i < count; ++i) out[i] -= of_model[i];
  }

  void residuals(const std::vector<std::size_t>& samples, const Jet* parameters, Jet* out) const override {
    const std::vector<Jet> of_system = pressures(second_, samples, parameters_of_second(parameters));
    const std::vector<Jet> of_model = pressures(model_, samples, parameters);
    std::transform(of_system.begin(), of_system.end(), of_model.begin(), out, std::minus<>());
  }

  std::vector<Batch::Input> columns() const override { return second_.columns(); }
  const ModelOnSamples* model() const override { return &second_; }

  Mask why_missing(std::size_t sample) const override {
    if (model_.is_missing_needed(sample)) return Mask::missing;
    return second_.is_missing_needed(sample) ? Mask::reference : Mask::impossible;
  }

 private:
  /// Parameters of the system's model, among all.
  template <class S>
  const S* parameters_of_second(const S* parameters) const {
    return parameters + model_.parameters().size();
  }

  /// Corrected pressures, with derivatives only if the parameters of the system have derivatives.
  std::vector<Jet> pressures(const ModelOnSamples& system, const std::vector<std::size_t>& samples,
                             const Jet* parameters) const {
    std::vector<double> constants;
    bool varies = false;
    for (const Jet* each = parameters; each != parameters + system.parameters().size(); ++each) {
      constants.push_back(each->a);
      varies = varies || !each->v.isZero(0.0);
    }
    std::vector<Jet> result;
    result.reserve(samples.size());
    for (const std::size_t sample : samples) {
      result.push_back(varies ? pressure_at(system, sample, parameters)
                              : Jet(pressure_at(system, sample, constants.data())));
    }
    return result;
  }

  template <class S>
  S pressure_at(const ModelOnSamples& system, std::size_t sample, const S* parameters) const {
    if (is_total()) return system.total_pressure(sample, parameters);
    State<S> state;
    return system.corrected_static_pressure(sample, parameters, state);
  }

  bool is_total() const { return compared_ == ComparedPressure::total_pressure; }

  ModelOnSamples second_;
  const ModelOnSamples& model_;
  ComparedPressure compared_;
};

/// Reference that is another pair of pressures of the aircraft, corrected by a separate model.
class SecondSystem final : public Reference {
 public:
  SecondSystem(ModelDefinition system, ComparedPressure compared)
      : system_(std::move(system)), compared_(compared) {}

  std::string description() const override {
    return (is_total() ? "total pressure of '" : "static system '") + system_.model.name + "'";
  }
  std::string name() const override { return (is_total() ? "total:" : "static:") + system_.model.name; }
  bool is_static_pressure() const override { return !is_total(); }
  bool sees_static_defect() const override { return !is_total(); }
  const ModelDefinition* model() const override { return &system_; }

  std::shared_ptr<const Reference> with_model(const ModelDefinition& system) const override {
    return std::make_shared<SecondSystem>(system, compared_);
  }

  std::vector<std::string> variables() const override {
    std::vector<std::string> names;
    for (const auto& [role, variable] : system_.variables) names.push_back(variable);
    return names;
  }

  std::string inputs() const override { return inputs_of(system_, false); }

  ModelSamples read(const Flight& flight, const std::vector<double>& time, Notes& notes) const override {
    return read_model_columns(flight, system_, false, time, notes);
  }

  std::unique_ptr<ReferenceOnSamples> on(const FlightSamples& samples,
                                         const ModelOnSamples& model) const override {
    return std::make_unique<SecondSystemOnSamples>(system_, compared_, samples, model);
  }

 private:
  bool is_total() const { return compared_ == ComparedPressure::total_pressure; }

  ModelDefinition system_;
  ComparedPressure compared_;
};

}  // namespace pcor::internal
