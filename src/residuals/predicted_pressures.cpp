#include "residuals/predicted_pressures.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "numerics/decompositions.hpp"
#include "numerics/low_pass.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

constexpr Eigen::Index terms = 5;
using Row = Eigen::Matrix<double, terms, 1>;

/// Replaces a series by its least-squares combination of a row of each sample; a value without a row stays.
/// @param row_of gives the row of a sample, not finite if an input is missing
/// @return false, with the series unchanged, if fewer than 300 samples have a row, or if the combination
/// misses the series by more than `max_rms`: then the other sensors do not measure the same air
template <class RowOf>
bool predict(std::vector<double>& series, double max_rms, const RowOf& row_of) {
  constexpr std::size_t min_rows = 300;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(terms, terms);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(terms);
  double squares = 0.0;
  std::size_t rows = 0;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const Row row = row_of(i);
    if (!row.allFinite() || !std::isfinite(series[i])) continue;
    normal += row * row.transpose();
    right += row * series[i];
    squares += series[i] * series[i];
    ++rows;
  }
  if (rows < min_rows) return false;
  const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Row solution = scale.asDiagonal() * pseudo_solution(scale.asDiagonal() * normal * scale.asDiagonal(),
                                                            scale.cwiseProduct(right), 1e-12);
  const double left = std::max(0.0, squares - solution.dot(right));
  if (!(std::sqrt(left / static_cast<double>(rows)) < max_rms)) return false;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const double value = row_of(i).dot(solution);
    if (std::isfinite(value)) series[i] = value;
  }
  return true;
}

constexpr double max_misfit_of_height = 0.02;  // in ln p: 160 m
constexpr double max_misfit_of_radome = 0.05;  // of the mean dynamic pressure

// Gaussian in time, s: several times the memory of the noise of transducers, about a minute.
constexpr double slow_part = 300.0;

/// Mean of the available values; NaN if there is no value.
double mean_of(const std::vector<double>& series) {
  double sum = 0.0;
  double count = 0.0;
  for (const double value : series) {
    if (!std::isfinite(value)) continue;
    sum += value;
    count += 1.0;
  }
  return sum / count;
}

}  // namespace

std::vector<double> predicted_by_radome(std::vector<double> dynamic_pressure, const ModelSamples& samples) {
  const std::vector<double>* const radome = samples.find(Quantity::radome_dynamic_pressure);
  const std::vector<double>* const pressure = samples.find(Quantity::static_pressure);
  if (radome == nullptr || pressure == nullptr) return dynamic_pressure;
  const std::vector<double>* const attack = samples.find(Quantity::attack_differential_pressure);
  const std::vector<double>* const sideslip = samples.find(Quantity::sideslip_differential_pressure);
  predict(dynamic_pressure, max_misfit_of_radome * mean_of(dynamic_pressure), [&](std::size_t i) -> Row {
    const double q = (*radome)[i];
    if (!(q > 0.0)) return Row::Constant(std::nan(""));
    const auto squared = [&](const std::vector<double>* angle) {
      return angle == nullptr ? 0.0 : (*angle)[i] * (*angle)[i] / q;
    };
    return Row{1.0, q, squared(attack), squared(sideslip), q * q / (*pressure)[i]};
  });
  return dynamic_pressure;
}

std::vector<double> predicted_by_height(std::vector<double> static_pressure,
                                        const std::vector<double>& altitude, double step) {
  if (altitude.size() != static_pressure.size()) return static_pressure;
  std::vector<double> recorded = static_pressure;
  for (double& value : recorded) value = std::log(value);
  std::vector<double> logarithm = recorded;
  const bool is_predicted = predict(logarithm, max_misfit_of_height, [&](std::size_t i) -> Row {
    const double z = 1e-4 * altitude[i];
    return Row{1.0, z, z * z, z * z * z, z * z * z * z};
  });
  if (!is_predicted) return static_pressure;
  for (std::size_t i = 0; i < recorded.size(); ++i) recorded[i] -= logarithm[i];
  const std::vector<double> slow = low_passed(recorded, slow_part / step);
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    if (std::isfinite(altitude[i]) && std::isfinite(slow[i]))
      static_pressure[i] = std::exp(logarithm[i] + slow[i]);
  }
  return static_pressure;
}

FlightSamples with_predicted_pressures(FlightSamples samples) {
  for (ModelSamples* const system : {&samples.model, &samples.reference}) {
    // The combination of the radome contains the static pressure.
    for (const Quantity quantity : {Quantity::static_pressure, Quantity::dynamic_pressure}) {
      std::vector<double>* const pressure = system->find(quantity);
      if (pressure == nullptr) continue;
      *pressure = quantity == Quantity::static_pressure
                      ? predicted_by_height(std::move(*pressure), samples.motion.altitude, samples.step)
                      : predicted_by_radome(std::move(*pressure), *system);
    }
  }
  return samples;
}

}  // namespace pcor::internal
