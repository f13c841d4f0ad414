#include "residuals/masks.hpp"

#include <pcor/numerics/noise.hpp>
#include <pcor/physics/lams.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "numerics/decompositions.hpp"
#include "numerics/median.hpp"

namespace pcor::internal {
namespace {

constexpr double lock_departure = 6.0;  // robust standard deviations
constexpr double min_deviation = 0.1;   // m/s
constexpr double by_angles = 0.03;      // relative airspeed: a static defect of 6 % of q
constexpr double scale_of_cauchy = 2.385;
constexpr int max_rounds = 20;
constexpr double min_eigenvalue = 1e-9;
constexpr std::size_t fewest = 30;
constexpr std::size_t beside = 5;  // samples on either side

/// Deviation of the laser from the factor of the majority of samples, m/s.
std::vector<double> departures(const Eigen::MatrixXd& columns, const Eigen::VectorXd& beam) {
  Eigen::VectorXd departure = beam - columns.col(0);
  for (int round = 0; round < max_rounds; ++round) {
    const double scale =
        scale_of_cauchy *
        std::max(robust_standard_deviation({departure.begin(), departure.end()}), min_deviation);
    const Eigen::VectorXd weight = (1.0 + (departure / scale).array().square()).rsqrt();
    const Eigen::MatrixXd weighted = weight.asDiagonal() * columns;
    const Eigen::VectorXd factor = pseudo_solution(
        weighted.transpose() * weighted, weighted.transpose() * weight.cwiseProduct(beam), min_eigenvalue);
    departure = beam - columns * factor;
  }
  return {departure.begin(), departure.end()};
}

}  // namespace

std::vector<std::size_t> find_unlocked(const std::vector<double>& beam, const std::vector<double>& airspeed,
                                       const std::vector<double>& ratio,
                                       const std::vector<std::size_t>& samples) {
  if (samples.size() < fewest) return {};
  std::vector<double> factors;
  std::vector<double> ratios;
  for (const std::size_t i : samples) {
    factors.push_back(beam[i] / airspeed[i]);
    ratios.push_back(ratio[i]);
  }
  const double usual = median(factors);
  const double middle = median(std::move(ratios));
  std::vector<bool> is_unlocked(samples.size(), true);
  std::vector<std::size_t> near;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (std::abs(factors[k] / usual - 1.0) < max_lams_departure) near.push_back(k);
  }
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(near.size()), 3);
  Eigen::VectorXd recorded(columns.rows());
  for (Eigen::Index row = 0; row < columns.rows(); ++row) {
    const std::size_t i = samples[near[static_cast<std::size_t>(row)]];
    const double expected = usual * airspeed[i];
    columns.row(row) << expected, expected * middle / ratio[i], expected * ratio[i] / middle;
    recorded[row] = beam[i];
  }
  const std::vector<double> departure = departures(columns, recorded);
  const double deviation = std::max(robust_standard_deviation(departure), min_deviation);
  for (std::size_t k = 0; k < near.size(); ++k) {
    is_unlocked[near[k]] =
        std::abs(departure[k]) > lock_departure * deviation + by_angles * airspeed[samples[near[k]]];
  }
  std::vector<std::size_t> unlocked;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const auto first = is_unlocked.begin() + static_cast<std::ptrdiff_t>(k - std::min(k, beside));
    const auto last =
        is_unlocked.begin() + static_cast<std::ptrdiff_t>(std::min(k + beside + 1, samples.size()));
    if (is_unlocked[k] || 2 * std::count(first, last, true) > last - first) unlocked.push_back(samples[k]);
  }
  return unlocked;
}

}  // namespace pcor::internal
