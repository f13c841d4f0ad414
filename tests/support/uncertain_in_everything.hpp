#pragma once

#include <cstddef>

#include <pcor/realtime/result_uncertainty.hpp>

namespace pcor::test {

/// Uncertainty of every parameter of a model and of every role.
inline ModelUncertainty uncertain_in_everything(const Model& model) {
  std::size_t count = 0;
  for (const ModelEffect& effect : model.effects) count += effect.parameters.size();
  ModelUncertainty uncertainty;
  uncertainty.covariance.assign(count * count, 0.0);
  for (std::size_t i = 0; i < count; ++i) uncertainty.covariance[i * count + i] = 1e-6;
  uncertainty.random.fill(0.1);
  return uncertainty;
}

}  // namespace pcor::test
