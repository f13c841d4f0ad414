#pragma once

#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "residuals/references/second_system.hpp"

namespace pcor::internal {

class TotalPressureOnSamples final : public SecondSystemOnSamples {
 public:
  using SecondSystemOnSamples::SecondSystemOnSamples;

  void residuals(const Block& block, const double* parameters, double* out) const override {
    std::vector<double> total(block.count);
    compared_model().total_pressure(block.model, block.count, parameters, total.data());
    law().total_pressure(block.reference, block.count, own_of(parameters), out);
    for (std::size_t i = 0; i < block.count; ++i) out[i] -= total[i];
  }

  void residuals(const std::size_t* samples, std::size_t count, const Jet* parameters,
                 Jet* out) const override {
    const Jet* const own_parameters = own_of(parameters);
    for (std::size_t i = 0; i < count; ++i) {
      out[i] = law().total_pressure(samples[i], own_parameters) -
               compared_model().total_pressure(samples[i], parameters);
    }
  }
};

class TotalPressureReference final : public SecondSystem {
 public:
  using SecondSystem::SecondSystem;

  std::string description() const override {
    return fmt::format("total pressure of '{}'", system().model.name);
  }
  std::string name() const override { return "total:" + system().model.name; }
  bool is_static_pressure() const override { return false; }
  bool sees_static_defect() const override { return false; }

  std::shared_ptr<const Reference> with_model(const ModelDefinition& system) const override {
    return std::make_shared<TotalPressureReference>(system);
  }

  std::unique_ptr<ReferenceOnSamples> on(const FlightSamples& samples,
                                         const ModelOnSamples& model) const override {
    return std::make_unique<TotalPressureOnSamples>(system(), samples, model);
  }
};

}  // namespace pcor::internal
