#pragma once

#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>

#include <pcor/residuals/reference.hpp>
#include "residuals/reference_on_samples.hpp"
#include "residuals/references/second_system.hpp"
#include "residuals/samples.hpp"

namespace pcor::internal {

class StaticSystemOnSamples final : public ReferenceOnSamples {
 public:
  StaticSystemOnSamples(const ModelFile& own, const FlightSamples& samples, const ModelOnSamples& model)
      : own_(own, samples.reference), model_(model) {}

  void residuals(const Block& block, const double* parameters, double* out) const override {
    std::vector<double> corrected(block.count);
    model_.corrected_static_pressure(block.model, block.count, parameters, corrected.data());
    own_.corrected_static_pressure(block.reference, block.count, parameters + model_.parameters().size(),
                                   out);
    for (std::size_t i = 0; i < block.count; ++i) out[i] -= corrected[i];
  }

  void residuals(const std::size_t* samples, std::size_t count, const Jet* parameters,
                 Jet* out) const override {
    const Jet* const own_parameters = parameters + model_.parameters().size();
    for (std::size_t i = 0; i < count; ++i) {
      State<Jet> state;
      State<Jet> own_state;
      out[i] = own_.corrected_static_pressure(samples[i], own_parameters, own_state) -
               model_.corrected_static_pressure(samples[i], parameters, state);
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

class StaticSystemReference final : public SecondSystem {
 public:
  using SecondSystem::SecondSystem;

  std::string description() const override { return fmt::format("static system '{}'", system().model.name); }
  std::string name() const override { return "static:" + system().model.name; }

  std::shared_ptr<const Reference> with_model(ModelFile system) const override {
    return std::make_shared<StaticSystemReference>(std::move(system));
  }

  std::unique_ptr<ReferenceOnSamples> on(const FlightSamples& samples,
                                         const ModelOnSamples& model) const override {
    return std::make_unique<StaticSystemOnSamples>(system(), samples, model);
  }
};

}  // namespace pcor::internal
