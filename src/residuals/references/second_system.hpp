#pragma once

#include <string>
#include <utility>
#include <vector>

#include <pcor/residuals/reference.hpp>
#include "residuals/samples.hpp"

namespace pcor::internal {

/// A reference that is another pair of pressures of the aircraft, corrected by a model of its own.
class SecondSystem : public Reference {
 public:
  explicit SecondSystem(ModelFile system) : system_(std::move(system)) {}

  const ModelFile* model() const override { return &system_; }

  std::vector<std::string> variables() const override {
    std::vector<std::string> names;
    for (const auto& [role, variable] : system_.variables) names.push_back(variable);
    return names;
  }

  ModelSamples read(const Flight& flight, const std::vector<double>& time,
                    std::vector<std::string>& notes) const override {
    return read_model_columns(flight, system_, false, time, notes);
  }

 protected:
  const ModelFile& system() const { return system_; }

 private:
  ModelFile system_;
};

}  // namespace pcor::internal
