#pragma once

#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "residuals/model_on_samples.hpp"
#include "residuals/reference_on_samples.hpp"
#include "residuals/references/second_system.hpp"

namespace pcor::internal {

class TotalPressureOnSamples final : public ReferenceOnSamples {
 public:
  TotalPressureOnSamples(const ModelFile& own, const FlightSamples& samples, const ModelOnSamples& model)
      : own_(own, samples.reference), model_(model) {}

  void residuals(const Block& block, const double* parameters, double* out) const override {
    std::vector<double> total(block.count);
    model_.total_pressure(block.model, block.count, parameters, total.data());
    own_.total_pressure(block.reference, block.count, parameters + model_.parameters().size(), out);
    for (std::size_t i = 0; i < block.count; ++i) out[i] -= total[i];
  }

  void residuals(const std::size_t* samples, std::size_t count, const Jet* parameters,
                 Jet* out) const override {
    const Jet* const own_parameters = parameters + model_.parameters().size();
    for (std::size_t i = 0; i < count; ++i) {
      out[i] =
          own_.total_pressure(samples[i], own_parameters) - model_.total_pressure(samples[i], parameters);
    }
  }

  std::vector<Batch::Input> columns() const override { return own_.columns(); }
  const ModelOnSamples* model() const override { return &own_; }

  Mask why_missing(std::size_t sample) const override {
    if (model_.is_missing_needed(sample)) return Mask::missing;
    return own_.is_missing_needed(sample) ? Mask::reference : Mask::impossible;
  }

 private:
  ModelOnSamples own_;
  const ModelOnSamples& model_;
};

class TotalPressureReference final : public SecondSystem {
 public:
  using SecondSystem::SecondSystem;

  std::string description() const override {
    return fmt::format("total pressure of '{}'", system().model.name);
  }
  std::string name() const override { return "total:" + system().model.name; }
  bool is_static_pressure() const override { return false; }

  std::shared_ptr<const Reference> with_model(ModelFile system) const override {
    return std::make_shared<TotalPressureReference>(std::move(system));
  }

  std::unique_ptr<ReferenceOnSamples> on(const FlightSamples& samples,
                                         const ModelOnSamples& model) const override {
    return std::make_unique<TotalPressureOnSamples>(system(), samples, model);
  }
};

}  // namespace pcor::internal
