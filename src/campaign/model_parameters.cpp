#include "campaign/model_parameters.hpp"

#include <cmath>

#include "model_io/sensor_uncertainty.hpp"

namespace pcor::internal {

std::size_t parameter_count(const Model& model) {
  std::size_t count = model.additions.size();
  for (const ModelEffect& effect : model.effects) count += effect.parameters.size();
  return count;
}

std::optional<std::size_t> first_parameter_of(const ModelDefinition& model, std::string_view effect) {
  std::size_t position = 0;
  for (const ModelEffect& each : model.model.effects) {
    if (each.id == effect) return position;
    position += each.parameters.size();
  }
  return std::nullopt;
}

std::vector<std::size_t> free_parameters(const ModelDefinition& model) {
  std::vector<std::size_t> free;
  std::size_t number = 0;
  for (std::size_t e = 0; e < model.model.effects.size(); ++e) {
    for (std::size_t p = 0; p < model.model.effects[e].parameters.size(); ++p, ++number) {
      if (!model.fit(e, p).fixed && !model.model.effects[e].is_surface()) free.push_back(number);
    }
  }
  return free;
}

Eigen::MatrixXd stated_covariance(const ModelDefinition& model) {
  const std::vector<double> stated = stated_uncertainty(model).covariance;
  const auto size = static_cast<Eigen::Index>(std::lround(std::sqrt(static_cast<double>(stated.size()))));
  return Eigen::Map<const Eigen::MatrixXd>(stated.data(), size, size);
}

}  // namespace pcor::internal
