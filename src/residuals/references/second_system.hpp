#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <pcor/residuals/reference.hpp>
#include "residuals/model_on_samples.hpp"
#include "residuals/reference_on_samples.hpp"
#include "residuals/samples.hpp"
#include "residuals/samples_key.hpp"

namespace pcor::internal {

/// Second system on the samples of a flight: its inputs, its model, and the reason for a missing sample,
/// common to all comparisons with the model.
class SecondSystemOnSamples : public ReferenceOnSamples {
 public:
  SecondSystemOnSamples(const ModelDefinition& system, const FlightSamples& samples,
                        const ModelOnSamples& model)
      : own_(system, samples.reference), model_(model) {}

  std::vector<Batch::Input> columns() const override { return own_.columns(); }
  const ModelOnSamples* model() const override { return &own_; }

  Mask why_missing(std::size_t sample) const override {
    if (model_.is_missing_needed(sample)) return Mask::missing;
    return own_.is_missing_needed(sample) ? Mask::reference : Mask::impossible;
  }

 protected:
  /// The system's model, and the model under comparison.
  const ModelOnSamples& law() const { return own_; }
  const ModelOnSamples& compared_model() const { return model_; }
  /// Parameters of the system's model, among all.
  template <class S>
  const S* own_of(const S* parameters) const {
    return parameters + model_.parameters().size();
  }

 private:
  ModelOnSamples own_;
  const ModelOnSamples& model_;
};

/// Reference that is another pair of pressures of the aircraft, corrected by a separate model.
class SecondSystem : public Reference {
 public:
  explicit SecondSystem(ModelDefinition system) : system_(std::move(system)) {}

  const ModelDefinition* model() const override { return &system_; }

  std::vector<std::string> variables() const override {
    std::vector<std::string> names;
    for (const auto& [role, variable] : system_.variables) names.push_back(variable);
    return names;
  }

  std::string inputs() const override { return inputs_of(system_, false); }

  ModelSamples read(const Flight& flight, const std::vector<double>& time, Notes& notes) const override {
    return read_model_columns(flight, system_, false, time, notes);
  }

 protected:
  const ModelDefinition& system() const { return system_; }

 private:
  ModelDefinition system_;
};

}  // namespace pcor::internal
