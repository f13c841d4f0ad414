#include "temperature/law_doubt.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include <pcor/batch/batch.hpp>
#include "campaign/model_parameters.hpp"
#include "numerics/decompositions.hpp"

namespace pcor::internal {
namespace {

std::vector<double> static_defect(const Model& model, const FlightSamples& samples) {
  const Batch batch(model, samples.model.roles);
  std::vector<Batch::Input> inputs;
  for (const Quantity input : batch.chain().inputs())
    inputs.push_back({input, samples.model.find(input)->data()});
  std::vector<double> defect(samples.time.size());
  batch.run(inputs, {{Quantity::static_defect, defect.data()}}, defect.size());
  return defect;
}

/// The model with `change` added to the coefficients of all its effects, in their order.
Model moved(Model model, const Eigen::VectorXd& change) {
  Eigen::Index next = 0;
  for (ModelEffect& effect : model.effects) {
    for (double& parameter : effect.parameters) parameter += change[next++];
  }
  return model;
}

/// One standard deviation of the coefficients along each principal axis of their covariance, scaled alike.
std::vector<Eigen::VectorXd> standard_deviations(const std::vector<double>& covariance, Eigen::Index count) {
  const Eigen::Map<const Eigen::MatrixXd> matrix(covariance.data(), count, count);
  const Eigen::VectorXd scale = matrix.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse = (scale.array() > 0.0).select(scale.cwiseInverse(), 0.0);
  const SymmetricEigen axes = symmetric_eigen(inverse.asDiagonal() * matrix * inverse.asDiagonal());
  std::vector<Eigen::VectorXd> changes;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (axes.eigenvalues()[k] > 0.0)
      changes.emplace_back(std::sqrt(axes.eigenvalues()[k]) * scale.cwiseProduct(axes.eigenvectors().col(k)));
  }
  return changes;
}

/// True if an uncertainty is stated of a coefficient of the law itself, not of a sensor.
bool states_law(const ModelDefinition& model, const ModelUncertainty& stated) {
  std::size_t position = 0;
  const auto count = static_cast<std::size_t>(std::lround(std::sqrt(stated.covariance.size())));
  for (const ModelEffect& effect : model.model.effects) {
    for (std::size_t p = 0; p < effect.parameters.size(); ++p, ++position) {
      if (location_of(effect) == EffectLocation::static_defect &&
          stated.covariance[position * count + position] > 0.0)
        return true;
    }
  }
  return false;
}

}  // namespace

std::optional<double> stated_law_variance(const ModelDefinition& model, const FlightAir& air) {
  const ModelUncertainty stated = uncertainty_of(model);
  const bool has_rest = stated.static_defect > 0.0 || stated.static_defect_ratio > 0.0;
  if (!has_rest && !states_law(model, stated)) return std::nullopt;
  double count = 0.0;
  double sum = 0.0;
  const auto add_mean_square = [&](const auto& value) {
    count = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < air.size(); ++i) {
      const double here = value(i);
      if (!air.flying[i] || std::isnan(here)) continue;
      squares += here * here;
      count += 1.0;
    }
    if (count > 0.0) sum += squares / count;
  };
  add_mean_square([&](std::size_t i) {
    return std::hypot(stated.static_defect, stated.static_defect_ratio * air.pressure[i]);
  });
  if (stated.has_systematic()) {
    const auto parameters = static_cast<Eigen::Index>(std::lround(std::sqrt(stated.covariance.size())));
    for (const Eigen::VectorXd& change : standard_deviations(stated.covariance, parameters)) {
      const std::vector<double> defect = static_defect(moved(model.model, change), *air.samples);
      add_mean_square([&](std::size_t i) { return defect[i] - air.static_defect[i]; });
    }
  }
  return sum;
}

}  // namespace pcor::internal
