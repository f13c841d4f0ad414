#pragma once

#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>

#include <pcor/residuals/reference.hpp>
#include "residuals/references/second_system.hpp"

namespace pcor::internal {

class StaticSystemOnSamples final : public SecondSystemOnSamples {
 public:
  using SecondSystemOnSamples::SecondSystemOnSamples;

  void residuals(const Block& block, const double* parameters, double* out) const override {
    std::vector<double> corrected(block.count);
    compared_model().corrected_static_pressure(block.model, block.count, parameters, corrected.data());
    law().corrected_static_pressure(block.reference, block.count, own_of(parameters), out);
    for (std::size_t i = 0; i < block.count; ++i) out[i] -= corrected[i];
  }

  void residuals(const std::size_t* samples, std::size_t count, const Jet* parameters,
                 Jet* out) const override {
    const Jet* const own_parameters = own_of(parameters);
    for (std::size_t i = 0; i < count; ++i) {
      State<Jet> state;
      State<Jet> own_state;
      out[i] = law().corrected_static_pressure(samples[i], own_parameters, own_state) -
               compared_model().corrected_static_pressure(samples[i], parameters, state);
    }
  }
};

class StaticSystemReference final : public SecondSystem {
 public:
  using SecondSystem::SecondSystem;

  std::string description() const override { return fmt::format("static system '{}'", system().model.name); }
  std::string name() const override { return "static:" + system().model.name; }

  std::shared_ptr<const Reference> with_model(const ModelDefinition& system) const override {
    return std::make_shared<StaticSystemReference>(system);
  }

  std::unique_ptr<ReferenceOnSamples> on(const FlightSamples& samples,
                                         const ModelOnSamples& model) const override {
    return std::make_unique<StaticSystemOnSamples>(system(), samples, model);
  }
};

}  // namespace pcor::internal
