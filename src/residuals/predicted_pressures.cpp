#include "residuals/predicted_pressures.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "numerics/decompositions.hpp"
#include "numerics/low_pass.hpp"
#include "numerics/missing.hpp"
#include "roles/pressure_height.hpp"

namespace pcor::internal {
namespace {

constexpr Eigen::Index terms = 5;
using Row = Eigen::Matrix<double, terms, 1>;

constexpr double max_misfit_of_height = 0.02;  // rms in ln p: 160 m
constexpr double max_misfit_of_radome = 0.05;  // rms, fraction of the mean dynamic pressure
constexpr double max_departure = 3.0;          // largest departure of a sample, in units of the largest rms

// Gaussian in time, s: several times the memory of the noise of transducers, about a minute.
constexpr double slow_part = 300.0;
constexpr double slow_block = 10.0;  // s

/// Least-squares combination of a row of each sample; NaN for a sample without a row.
/// @param row_of gives the row of a sample, not finite if an input is missing
/// @return empty if fewer than 300 samples have a row, or if the combination misses the series by more than
/// `max_rms`: then the other sensors do not measure the same air
template <class RowOf>
std::vector<double> combination(const std::vector<double>& series, double max_rms, const RowOf& row_of) {
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
  if (rows < min_rows) return {};
  const Row solution = pseudo_solution(normal, right);
  const double residual_squares = std::max(0.0, squares - solution.dot(right));
  if (!(std::sqrt(residual_squares / static_cast<double>(rows)) < max_rms)) return {};
  std::vector<double> result(series.size());
  for (std::size_t i = 0; i < series.size(); ++i) result[i] = row_of(i).dot(solution);
  return result;
}

/// Slow part of a series with missing values, from means over blocks of ten seconds; NaN far from all values.
std::vector<double> slow_part_of(const std::vector<double>& series, double step) {
  const auto width = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(slow_block / step)));
  std::vector<double> blocks;
  for (std::size_t first = 0; first < series.size(); first += width) {
    const auto begin = series.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = begin + static_cast<std::ptrdiff_t>(std::min(width, series.size() - first));
    blocks.push_back(mean_of({begin, end}));
  }
  blocks = low_passed(blocks, slow_part / (step * static_cast<double>(width)));
  std::vector<double> result(series.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double position = std::clamp((static_cast<double>(i) + 0.5) / static_cast<double>(width) - 0.5, 0.0,
                                       static_cast<double>(blocks.size() - 1));
    const auto before = static_cast<std::size_t>(position);
    const std::size_t after = std::min(before + 1, blocks.size() - 1);
    const double part = position - static_cast<double>(before);
    const double between = blocks[before] + part * (blocks[after] - blocks[before]);
    result[i] = std::isfinite(between) ? between : blocks[part < 0.5 ? before : after];
  }
  return result;
}

}  // namespace

std::vector<double> predicted_by_radome(std::vector<double> dynamic_pressure, const ModelSamples& samples) {
  const std::vector<double>* const radome = samples.find(Quantity::radome_dynamic_pressure);
  const std::vector<double>* const pressure = samples.find(Quantity::static_pressure);
  if (radome == nullptr || pressure == nullptr) return dynamic_pressure;
  const std::vector<double>* const attack = samples.find(Quantity::attack_differential_pressure);
  const std::vector<double>* const sideslip = samples.find(Quantity::sideslip_differential_pressure);
  const double max_rms = max_misfit_of_radome * mean_of(dynamic_pressure);
  const std::vector<double> predicted = combination(dynamic_pressure, max_rms, [&](std::size_t i) -> Row {
    const double q = (*radome)[i];
    if (!(q > 0.0)) return Row::Constant(nan);
    const auto squared = [&](const std::vector<double>* angle) {
      return angle == nullptr ? 0.0 : (*angle)[i] * (*angle)[i] / q;
    };
    return Row{1.0, q, squared(attack), squared(sideslip), q * q / (*pressure)[i]};
  });
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    if (std::abs(predicted[i] - dynamic_pressure[i]) < max_departure * max_rms)
      dynamic_pressure[i] = predicted[i];
  }
  return dynamic_pressure;
}

std::vector<double> predicted_by_height(std::vector<double> static_pressure,
                                        const std::vector<double>& altitude, double step) {
  if (altitude.size() != static_pressure.size()) return static_pressure;
  std::vector<double> logarithm = static_pressure;
  for (double& value : logarithm) value = value > 0.0 ? std::log(value) : nan;
  const std::vector<double> predicted =
      combination(logarithm, max_misfit_of_height, [&](std::size_t i) -> Row {
        const double z = 1e-4 * altitude[i];
        return Row{1.0, z, z * z, z * z * z, z * z * z * z};
      });
  if (predicted.empty()) return static_pressure;
  std::vector<double> residual(logarithm.size());
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] = logarithm[i] - predicted[i];
  const std::vector<double> slow = slow_part_of(residual, step);
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (std::abs(residual[i] - slow[i]) < max_departure * max_misfit_of_height)
      static_pressure[i] = std::exp(predicted[i] + slow[i]);
  }
  return static_pressure;
}

FlightSamples with_predicted_pressures(FlightSamples samples, const FlightSamples& recorded) {
  std::vector<double> altitude = samples.motion.altitude;
  for (const ModelSamples* const system : {&recorded.model, &recorded.reference}) {
    const std::vector<double>* const pressure = system->find(Quantity::static_pressure);
    if (pressure != nullptr && pressure->size() == altitude.size() &&
        compare_height(altitude, *pressure).kind == HeightEvidence::Kind::pressure_altitude)
      altitude.clear();
  }
  for (ModelSamples* const system : {&samples.model, &samples.reference}) {
    if (std::vector<double>* const pressure = system->find(Quantity::static_pressure))
      *pressure = predicted_by_height(std::move(*pressure), altitude, samples.step);
    // The radome is that of the model; its combination contains the static pressure.
    if (std::vector<double>* const pressure = system->find(Quantity::dynamic_pressure))
      *pressure = predicted_by_radome(std::move(*pressure), samples.model);
  }
  return samples;
}

}  // namespace pcor::internal
