#include "residuals/radome_prediction.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "numerics/decompositions.hpp"

namespace pcor::internal {

std::vector<double> predicted_by_radome(std::vector<double> dynamic_pressure, const ModelSamples& samples) {
  constexpr Eigen::Index terms = 5;
  constexpr std::size_t fewest = 300;
  const std::vector<double>* const radome = samples.find(Quantity::radome_dynamic_pressure);
  const std::vector<double>* const pressure = samples.find(Quantity::static_pressure);
  if (radome == nullptr || pressure == nullptr) return dynamic_pressure;
  const std::vector<double>* const attack = samples.find(Quantity::attack_differential_pressure);
  const std::vector<double>* const sideslip = samples.find(Quantity::sideslip_differential_pressure);
  using Row = Eigen::Matrix<double, terms, 1>;
  const auto row_of = [&](std::size_t i) -> Row {
    const double q = (*radome)[i];
    const auto squared = [&](const std::vector<double>* angle) {
      return angle == nullptr ? 0.0 : (*angle)[i] * (*angle)[i] / q;
    };
    Row row;
    row << 1.0, q, squared(attack), squared(sideslip), q * q / (*pressure)[i];
    return row;
  };
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(terms, terms);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(terms);
  std::size_t rows = 0;
  for (std::size_t i = 0; i < dynamic_pressure.size(); ++i) {
    const Row row = row_of(i);
    if (!row.allFinite() || !((*radome)[i] > 0.0) || !std::isfinite(dynamic_pressure[i])) continue;
    normal += row * row.transpose();
    right += row * dynamic_pressure[i];
    ++rows;
  }
  if (rows < fewest) return dynamic_pressure;
  const Row solution = pseudo_solution(normal, right, 1e-12);
  for (std::size_t i = 0; i < dynamic_pressure.size(); ++i) {
    const double predicted = row_of(i).dot(solution);
    if (std::isfinite(predicted) && (*radome)[i] > 0.0) dynamic_pressure[i] = predicted;
  }
  return dynamic_pressure;
}

}  // namespace pcor::internal
